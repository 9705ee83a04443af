// Claim delaunay.
//   Statements  Local: across every interior facet, the far vertex of one cell is not strictly inside the
//               circumsphere of the other. Global: no vertex that a cell uses is strictly inside any cell's
//               circumsphere. Vertices exactly on a sphere are ties, which are counted and allowed: they
//               leave the choice open.
//   Rests on    Exact side-of-sphere decisions in the coordinates of the file. A flat cell has no
//               circumsphere and is a violation. The local statement does not imply the global one here, as a
//               mesh of the inside alone is not convex.
//   Cost        About n log n. The global test asks a tree of all vertices for those in a ball slightly
//               larger than the circumball. These are few, unless very many vertices lie near one sphere.
//   Not proved  That the mesh is the triangulation of all its vertices: it may lack cells (a part of the
//               triangulation is Delaunay too).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/box_tree.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

struct Ball {
  Point center{};
  double radius = 0;
};

template <class T>
Vector<T> center_from_last(const CellPoints& p) {
  const Vector<T> a = difference<T>(p[0], p[3]), b = difference<T>(p[1], p[3]), c = difference<T>(p[2], p[3]);
  const Vector<T> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const T a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), twice = T(2) * dot(a, bc);
  Vector<T> center;
  for (std::size_t i = 0; i < 3; ++i) center[i] = (a2 * bc[i] + b2 * ca[i] + c2 * ab[i]) / twice;
  return center;
}

// True if the rounded center is off by less than kSlack radii. Let L be the longest edge from the last
// vertex, R >= L / 2, and e = 2^-53. The error of det is below 16 e L^3. The error of a component of the
// numerator is below 64 e L^4. The center is their quotient over 2 det. If L^3 <= 1e7 |det|, its error is
// therefore below (32 e L^4 / |det| + 16 e L^3 R / |det|) < 1e-6 R. The range of L keeps all terms from over-
// and underflow.
bool is_in_good_shape(const CellPoints& p) {
  const auto a = difference<double>(p[0], p[3]), b = difference<double>(p[1], p[3]),
             c = difference<double>(p[2], p[3]);
  const double longest2 = std::max({dot(a, a), dot(b, b), dot(c, c)}), det = dot(a, cross(b, c));
  return longest2 > 1e-40 && longest2 < 1e40 && longest2 * longest2 * longest2 <= 1e14 * det * det;
}
constexpr double kSlack = 1e-5;

// Returns a ball that contains the circumball. It is the rounded circumball, or the exact one rounded,
// enlarged by more than the errors of its center, its radius and of distances from the center. It is infinite
// if doubles do not suffice.
Ball ball_around(const CellPoints& p) {
  Vector<double> from_last{};
  if (is_in_good_shape(p)) {
    from_last = center_from_last<double>(p);
  } else {
    const auto exact = center_from_last<Rational>(p);
    for (std::size_t i = 0; i < 3; ++i) from_last[i] = CGAL::to_double(exact[i]);
  }
  Ball ball;
  double extent = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ball.center[i] = p[3][i] + from_last[i];
    extent = std::max(extent, std::fabs(ball.center[i]));
  }
  ball.radius = std::sqrt(dot(from_last, from_last)) * (1 + kSlack) + 1e-14 * extent + 1e-150;
  if (!std::isfinite(ball.radius * ball.radius)) ball = {{}, std::numeric_limits<double>::infinity()};
  return ball;
}

bool meets(const Ball& ball, const Bounds& box) {
  double squared = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = std::max({box.low[a] - ball.center[a], ball.center[a] - box.high[a], 0.0});
    squared += d * d;
  }
  return squared <= ball.radius * ball.radius;
}

class Spheres {
 public:
  Spheres(const Mesh& mesh, const Adjacency& adjacency) : mesh_(mesh), adjacency_(adjacency) {}

  bool is_flat(CellId c, Tally& t) const {
    const CellPoints p = points_of(mesh_, c);
    return orientation(p[0], p[1], p[2], p[3], t.num_exact) == 0;
  }
  void check_facets(CellId c, Tally& t) const {
    for (FacetId f = 4 * c; f < 4 * c + 4; ++f) {
      const FacetId mirror = adjacency_.mirror[f];
      if (mirror == kNone || mirror < f) continue;
      check_vertex(c, far_vertex(mesh_, mirror), "no facet's far vertex is inside the sphere", t);
    }
  }
  void check_ball(CellId c, const BoxTree& vertices, const std::vector<std::uint8_t>& is_used,
                  Tally& t) const {
    const Ball ball = ball_around(points_of(mesh_, c));
    vertices.for_each_near([&](const Bounds& box) { return meets(ball, box); },
                           [&](VertexId v) {
                             const Point& p = mesh_.vertices[v];
                             if (!is_used[v] || !meets(ball, {p, p}) || is_own(c, v)) return;
                             check_vertex(c, v, "no vertex is inside a circumsphere", t);
                           });
  }

 private:
  bool is_own(CellId c, VertexId v) const {
    return std::find(mesh_.cells[c].begin(), mesh_.cells[c].end(), v) != mesh_.cells[c].end();
  }
  void check_vertex(CellId c, VertexId v, const char* statement, Tally& t) const {
    const CellPoints p = points_of(mesh_, c);
    const Point& x = mesh_.vertices[v];
    ++t.num_checked;
    const int side = side_of_sphere(p[0], p[1], p[2], p[3], x, t.num_exact);
    t.num_ties += side == 0;
    if (side <= 0) return;
    const double depth = depth_of(p, x);
    Witness witness = cell_witness(mesh_, c, statement, depth, depth);
    witness.vertices.push_back(v);
    witness.points.push_back(x);
    t.violation(std::move(witness));
  }
  // Returns how deep x is in the ball, relative to its radius; rounded.
  static double depth_of(const CellPoints& p, const Point& x) {
    const auto from_last = center_from_last<double>(p);
    Vector<double> d = difference<double>(x, p[3]);
    for (std::size_t i = 0; i < 3; ++i) d[i] -= from_last[i];
    const double depth = 1 - std::sqrt(dot(d, d) / dot(from_last, from_last));
    return std::isfinite(depth) ? depth : 0;
  }

  const Mesh& mesh_;
  const Adjacency& adjacency_;
};

BoxTree tree_of_vertices(const Mesh& mesh) {
  std::vector<Bounds> boxes;
  boxes.reserve(mesh.vertices.size());
  for (const Point& p : mesh.vertices) boxes.push_back({p, p});
  return BoxTree(boxes);
}

}  // namespace

ClaimResult check_delaunay(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  const Spheres spheres(mesh, adjacency);
  const Tally local = tally_over(mesh.cells.size(), options.threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    if (spheres.is_flat(c, t)) {
      t.violation(cell_witness(mesh, c, "every cell has a circumsphere", 0, 0));
    } else {
      spheres.check_facets(c, t);
    }
  });
  const BoxTree vertices = tree_of_vertices(mesh);
  const std::vector<std::uint8_t> is_used = used_vertices(mesh);
  const Tally global = tally_over(mesh.cells.size(), options.threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    if (!spheres.is_flat(c, t)) spheres.check_ball(c, vertices, is_used, t);
  });

  Tally both = local;
  both.add(global);
  ClaimResult result = result_of("delaunay", both);
  result.method = "floating-point filter with a proven bound, then the exact side-of-sphere of CGAL's kernel";
  result.details()["local_violations"] = local.num_violations;
  result.details()["global_violations"] = global.num_violations;
  result.details()["cospherical_facets"] = local.num_ties;
  result.details()["cospherical_vertices"] = global.num_ties;
  result.details()["facets_checked"] = local.num_checked;
  result.reason =
      fmt::format("{} facets not locally Delaunay, {} vertices inside circumballs; {} facets cospherical",
                  local.num_violations, global.num_violations, local.num_ties);
  return result;
}

}  // namespace podm::verify
