// Claim delaunay.
//   Statement   local: across every interior facet, the far vertex of the one cell is not strictly inside the
//               circumsphere of the other. Global: no vertex that a cell uses is strictly inside any cell's
//               circumsphere. Vertices exactly on a sphere are ties, counted and allowed: they leave the
//               choice open.
//   Rests on    exact side-of-sphere decisions in the coordinates of the file. A flat cell has no
//   circumsphere and
//               counts as a violation. Local does not imply global here, for a mesh of the inside alone is
//               not convex.
//   Cost        linear; the global test asks a grid of all vertices for those in each circumball's box, which
//   are few
//               where the claim holds.
//   Not proved  that the mesh is the triangulation of all vertices: it may lack cells (a part of it is
//   Delaunay too).
#include <fmt/format.h>

#include <cmath>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/box_grid.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// A ball that holds the circumball: the rounded one, made larger by far more than its error where the cell is
// in good shape (error below 1e-6 of the radius when L^3 <= 1e7 |det|), else of the exact centre.
struct Ball {
  Point center{};
  double radius = 0;
};
constexpr double kSlack = 1e-5;

template <class T>
Vector<T> center_from_last(const CellPoints& p) {
  const Vector<T> a = difference<T>(p[0], p[3]), b = difference<T>(p[1], p[3]), c = difference<T>(p[2], p[3]);
  const Vector<T> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const T a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), twice = T(2) * dot(a, bc);
  Vector<T> center;
  for (std::size_t i = 0; i < 3; ++i) center[i] = (a2 * bc[i] + b2 * ca[i] + c2 * ab[i]) / twice;
  return center;
}

Ball ball_around(const CellPoints& p) {
  const auto a = difference<double>(p[0], p[3]), b = difference<double>(p[1], p[3]),
             c = difference<double>(p[2], p[3]);
  const double longest2 = std::max({dot(a, a), dot(b, b), dot(c, c)}), det = dot(a, cross(b, c));
  const bool is_in_good_shape = longest2 * longest2 * longest2 <= 1e14 * det * det;
  Vector<double> from_last{};
  if (is_in_good_shape) {
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
  ball.radius = std::sqrt(dot(from_last, from_last)) * (1 + kSlack) + 1e-14 * extent;
  return ball;
}

class Spheres {
 public:
  Spheres(const Mesh& mesh, const Adjacency& adjacency) : mesh_(mesh), adjacency_(adjacency) {}

  // False: the cell is flat, which is a violation by itself.
  bool check_cell(CellId c, Tally& t) const {
    const CellPoints p = points_of(mesh_, c);
    if (orientation(p[0], p[1], p[2], p[3]) != 0) return true;
    t.violation(witness("every cell has a circumsphere", c, kNone, 0));
    return false;
  }
  void check_facets(CellId c, Tally& t) const {
    for (FacetId f = 4 * c; f < 4 * c + 4; ++f) {
      const FacetId mirror = adjacency_.mirror[f];
      if (mirror == kNone || mirror < f) continue;
      check_vertex(c, mesh_.cells[mirror / 4][mirror % 4], "no facet's far vertex is inside the sphere", t);
    }
  }
  bool is_own(CellId c, VertexId v) const {
    return std::find(mesh_.cells[c].begin(), mesh_.cells[c].end(), v) != mesh_.cells[c].end();
  }
  void check_vertex(CellId c, VertexId v, const char* statement, Tally& t) const {
    const CellPoints p = points_of(mesh_, c);
    ++t.num_checked;
    const int side = side_of_sphere(p[0], p[1], p[2], p[3], mesh_.vertices[v]);
    t.num_ties += side == 0;
    if (side > 0) t.violation(witness(statement, c, v, depth(p, mesh_.vertices[v])));
  }

 private:
  // How deep in the ball, as a part of its radius; rounded.
  static double depth(const CellPoints& p, const Point& x) {
    const auto from_last = center_from_last<double>(p);
    Vector<double> d = difference<double>(x, p[3]);
    for (std::size_t i = 0; i < 3; ++i) d[i] -= from_last[i];
    const double depth = 1 - std::sqrt(dot(d, d) / dot(from_last, from_last));
    return std::isfinite(depth) ? depth : 0;
  }
  Witness witness(const char* statement, CellId c, VertexId v, double value) const {
    const CellPoints p = points_of(mesh_, c);
    Witness w{.statement = statement,
              .cells = {c},
              .vertices = {mesh_.cells[c].begin(), mesh_.cells[c].end()},
              .points = {p.begin(), p.end()},
              .value = value,
              .severity = value,
              .label = mesh_.cell_labels.empty() ? 0 : mesh_.cell_labels[c]};
    if (v != kNone) {
      w.vertices.push_back(v);
      w.points.push_back(mesh_.vertices[v]);
    }
    return w;
  }

  const Mesh& mesh_;
  const Adjacency& adjacency_;
};

std::vector<std::uint8_t> used_vertices(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto& cell : mesh.cells)
    for (const VertexId v : cell) used[v] = 1;
  return used;
}

}  // namespace

ClaimResult check_delaunay(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  const Spheres spheres(mesh, adjacency);
  const Tally local = tally_over(mesh.cells.size(), options.threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    if (spheres.check_cell(c, t)) spheres.check_facets(c, t);
  });

  std::vector<Bounds> boxes;
  for (const Point& p : mesh.vertices) boxes.push_back({p, p});
  const BoxGrid grid(boxes);
  boxes = {};
  const std::vector<std::uint8_t> is_used = used_vertices(mesh);
  const Tally global = tally_over(mesh.cells.size(), options.threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints p = points_of(mesh, c);
    if (orientation(p[0], p[1], p[2], p[3]) == 0) return;  // counted above
    const Ball ball = ball_around(p);
    Bounds box{ball.center, ball.center};
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] -= ball.radius;
      box.high[a] += ball.radius;
    }
    grid.for_each_near(box, [&](VertexId v) {
      const auto d = difference<double>(mesh.vertices[v], ball.center);
      if (!(dot(d, d) <= ball.radius * ball.radius) || !is_used[v] || spheres.is_own(c, v)) return;
      spheres.check_vertex(c, v, "no vertex is inside a circumsphere", t);
    });
  });

  Tally both = local;
  both.add(global);
  ClaimResult result = result_of("delaunay", both);
  result.method = "filtered exact side-of-sphere of the CGAL kernel";
  result.details["local_violations"] = local.num_violations;
  result.details["global_violations"] = global.num_violations;
  result.details["cospherical_facets"] = local.num_ties;
  result.details["cospherical_vertices"] = global.num_ties;
  result.details["facets_checked"] = local.num_checked;
  result.reason = fmt::format("{} facets and {} balls not Delaunay; {} facets cospherical",
                              local.num_violations, global.num_violations, local.num_ties);
  return result;
}

}  // namespace podm::verify
