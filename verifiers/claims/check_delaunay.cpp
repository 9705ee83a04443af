// Claim delaunay.
//   Statements  Local: across every interior facet, the far vertex of one cell is not strictly inside the
//               circumsphere of the other. Global: no vertex that a cell uses is strictly inside any cell's
//               circumsphere. Vertices exactly on a sphere are ties, which are counted and allowed: they
//               leave the choice open.
//   Rests on    Exact side-of-sphere decisions in the coordinates of the file. A flat cell has no
//               circumsphere and is a violation. The local statement does not imply the global one here, as a
//               mesh of the inside alone is not convex.
//   Cost        About n log n. The global test asks a tree of all vertices for those in a ball slightly
//               larger than the circumball. These are few, unless very many vertices lie near one sphere. On
//               ranks, a cell is sent to each rank with a vertex box that its ball meets; a rank has up to
//               64 boxes. The ranks send cells in batches of bounded size.
//   Not proved  That the mesh is the triangulation of all its vertices: it may lack cells (a part of the
//               triangulation is Delaunay too).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/box_tree.h"
#include "geometry/measures.h"
#include "geometry/rank_boxes.h"

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

// The rank's own vertices that cells use.
struct UsedVertices {
  std::vector<VertexId> ids;
  BoxTree tree;  // of positions in `ids`

  explicit UsedVertices(const Mesh& mesh) : ids(own_used_vertices(mesh)), tree(boxes(mesh)) {}

 private:
  static std::vector<VertexId> own_used_vertices(const Mesh& mesh) {
    const std::vector<std::uint8_t> is_used = used_vertices(mesh);
    std::vector<VertexId> found;
    for (VertexId v = 0; v < mesh.vertices.size(); ++v)
      if (is_used[v] && owns_vertex(mesh, v)) found.push_back(v);
    return found;
  }
  std::vector<Bounds> boxes(const Mesh& mesh) const {
    std::vector<Bounds> all;
    all.reserve(ids.size());
    for (const VertexId v : ids) all.push_back({mesh.vertices[v], mesh.vertices[v]});
    return all;
  }
};

// A cell that may be another rank's.
struct SphereCell {
  GlobalId id;
  std::array<GlobalId, 4> vertices;
  CellPoints points;
  LabelValue label;
};

SphereCell sphere_cell(const Mesh& mesh, CellId c) {
  SphereCell cell{global_cell(mesh, c), {}, points_of(mesh, c), 0};
  for (std::size_t i = 0; i < 4; ++i) cell.vertices[i] = global_vertex(mesh, mesh.cells[c][i]);
  if (!mesh.cell_labels.empty()) cell.label = mesh.cell_labels[c];
  return cell;
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
      check_vertex(sphere_cell(mesh_, c), far_vertex(mesh_, mirror),
                   "no facet's far vertex is inside the sphere", t);
    }
  }
  // Checks the rank's own vertices that cells use.
  void check_ball(const SphereCell& cell, const Ball& ball, const UsedVertices& vertices, Tally& t) const {
    vertices.tree.for_each_near([&](const Bounds& box) { return meets(ball, box); },
                                [&](std::uint32_t i) {
                                  const VertexId v = vertices.ids[i];
                                  const Point& p = mesh_.vertices[v];
                                  if (!meets(ball, {p, p}) || has_vertex(cell, global_vertex(mesh_, v)))
                                    return;
                                  check_vertex(cell, v, "no vertex is inside a circumsphere", t);
                                });
  }

 private:
  static bool has_vertex(const SphereCell& cell, GlobalId v) {
    return std::find(cell.vertices.begin(), cell.vertices.end(), v) != cell.vertices.end();
  }
  void check_vertex(const SphereCell& cell, VertexId v, const char* statement, Tally& t) const {
    const CellPoints& p = cell.points;
    const Point& x = mesh_.vertices[v];
    ++t.num_checked;
    const int side = side_of_sphere(p[0], p[1], p[2], p[3], x, t.num_exact);
    t.num_ties += side == 0;
    if (side <= 0) return;
    const double depth = depth_of(p, x);
    Witness witness{.statement = statement,
                    .cells = {cell.id},
                    .vertices = {cell.vertices.begin(), cell.vertices.end()},
                    .points = {p.begin(), p.end()},
                    .value = depth,
                    .severity = depth,
                    .label = cell.label};
    witness.vertices.push_back(global_vertex(mesh_, v));
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

// Holds what the global test finds on a rank, and the cells that other ranks have to test, by rank.
struct GlobalPart {
  Tally tally;
  std::vector<std::vector<CellId>> cells_for;

  void add(const GlobalPart& other) {
    tally.add(other.tally);
    for (std::size_t r = 0; r < cells_for.size(); ++r)
      cells_for[r].insert(cells_for[r].end(), other.cells_for[r].begin(), other.cells_for[r].end());
  }
};

// Collective. Calls visit(cells) with the cells that other ranks have this rank test. No rank sends or
// receives more than kCellsAtOnce at once, 150 MB.
constexpr std::size_t kCellsAtOnce = std::size_t{1} << 20;
template <class Visit>
void for_each_batch_of_guests(const Mesh& mesh, const std::vector<std::vector<CellId>>& cells_for,
                              const Visit& visit) {
  Communication& ranks = ranks_of(mesh);
  const std::size_t most = std::max(kCellsAtOnce / cells_for.size(), std::size_t{1});  // to a rank
  std::size_t num_batches = 0;
  for (const auto& cells : cells_for) num_batches = std::max(num_batches, (cells.size() + most - 1) / most);
  for (const std::size_t of_rank : gather(ranks, num_batches)) num_batches = std::max(num_batches, of_rank);
  for (std::size_t batch = 0; batch < num_batches; ++batch) {
    auto lists = lists_for<SphereCell>(ranks);
    for (std::size_t r = 0; r < lists.size(); ++r)
      for (std::size_t i = batch * most; i < std::min((batch + 1) * most, cells_for[r].size()); ++i)
        lists[r].push_back(sphere_cell(mesh, cells_for[r][i]));
    visit(exchange_joined(ranks, std::move(lists)));
  }
}

Tally check_all_vertices(const Mesh& mesh, const Spheres& spheres, int threads) {
  const UsedVertices vertices(mesh);
  const RankBoxes boxes(ranks_of(mesh), vertices.tree.boxes_at(kLevelsOfRankBoxes));
  GlobalPart own =
      tally_over(own_cells(mesh), threads, GlobalPart{{}, lists_for<CellId>(ranks_of(mesh))},
                 [&](std::size_t i, GlobalPart& part) {
                   const auto c = static_cast<CellId>(i);
                   if (spheres.is_flat(c, part.tally)) return;
                   const SphereCell cell = sphere_cell(mesh, c);
                   const Ball ball = ball_around(cell.points);
                   spheres.check_ball(cell, ball, vertices, part.tally);
                   boxes.for_each_other([&](const Bounds& box) { return meets(ball, box); },
                                        [&](std::size_t rank) { part.cells_for[rank].push_back(c); });
                 });
  for_each_batch_of_guests(mesh, own.cells_for, [&](const std::vector<SphereCell>& guests) {
    own.tally.add(tally_over({0, guests.size()}, threads, {}, [&](std::size_t i, Tally& t) {
      spheres.check_ball(guests[i], ball_around(guests[i].points), vertices, t);
    }));
  });
  return over_ranks(mesh, std::move(own.tally));
}

}  // namespace

ClaimResult check_delaunay(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  const Spheres spheres(mesh, adjacency);
  const Tally own = tally_over(own_cells(mesh), options.threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    if (spheres.is_flat(c, t)) {
      t.violation(cell_witness(mesh, c, "every cell has a circumsphere", 0, 0));
    } else {
      spheres.check_facets(c, t);
    }
  });
  const Tally local = over_ranks(mesh, own), global = check_all_vertices(mesh, spheres, options.threads);

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
