// Claim conformity.
//   Statements  Parts that were made apart share their facets: no two facets with one cell each lie at the
//               same place, and no two vertices of such facets do. With a schedule, three statements are
//               added. No two vertices of cells at a leaf boundary lie at the same place; a facet that
//               crosses or touches a leaf boundary is therefore shared by two cells or is on the mesh's
//               boundary. Leaves do not overlap, and no two leaves that are active at the same time are
//               within two rings of each other. No operation touched a vertex outside its leaf and the first
//               ring.
//   Rests on    Equality of coordinates, and integers on the leaf grid. Ring 1 of a leaf is the leaves whose
//               closed cubes touch it; ring 2 is the leaves that touch ring 1. An activation lasts from its
//               beginning up to, not including, its end; an activation without length is the instant between.
//               Vertices at a leaf boundary are found in doubles with a margin above their rounding, so a few
//               more are checked, never fewer. The schedule is the mesher's own account of its run.
//   Cost        n log n in facets with one cell and in vertices at leaf boundaries. In the schedule, an
//               activation costs the leaves of its first ring.
//   Not proved  That facets which lie together only in part match: the structure claim finds them as hanging
//               vertices and overlaps, the surface claim as a gap.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "claims/check_conformity_schedule.h"
#include "claims/claims.h"
#include "claims/coincidence.h"
#include "claims/tally.h"

namespace podm::verify {

namespace {

std::vector<FacetId> facets_with_one_cell(const Mesh& mesh, const Adjacency& adjacency) {
  std::vector<FacetId> facets;
  const IdRange own = own_facets(mesh);
  for (auto f = static_cast<FacetId>(own.begin); f < own.end; ++f)
    if (adjacency.mirror[f] == kNone) facets.push_back(f);
  return facets;
}

// Compares facets by place, whatever their vertices' ids are.
Tally check_facets(const Mesh& mesh, const std::vector<FacetId>& open_facets) {
  std::vector<Placed<std::array<Point, 3>>> facets;
  facets.reserve(open_facets.size());
  for (const FacetId f : open_facets) {
    const auto v = vertices_of(mesh, f);
    facets.push_back({{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]},
                      4 * global_cell(mesh, f / 4) + f % 4});
    std::sort(facets.back().place.begin(), facets.back().place.end());
  }
  facets = sorted_by_place(mesh, std::move(facets), [](const auto& points) { return points[0]; });
  Tally tally;
  tally.num_checked = facets.size();
  for (std::size_t i = 0; i + 1 < facets.size(); ++i) {
    if (facets[i].place != facets[i + 1].place) continue;
    tally.violation({.statement = "facets with the same coordinates are one facet",
                     .cells = {facets[i].id / 4, facets[i + 1].id / 4},
                     .points = {facets[i].place.begin(), facets[i].place.end()}});
  }
  return tally;
}

// The position of each vertex relative to the planes of the leaves' faces. The planes reach beyond the
// leaves.
class LeafBoundaries {
 public:
  LeafBoundaries(const Mesh& mesh, const Schedule& schedule) : slots_(mesh.vertices.size()) {
    std::array<std::vector<double>, 3> planes;
    for (const Leaf& leaf : schedule.leaves)
      for (std::size_t a = 0; a < 3; ++a)
        for (const std::int64_t x : {leaf.corner[a], leaf.corner[a] + leaf.side})
          planes[a].push_back(static_cast<double>(x));
    for (auto& of_axis : planes) {
      std::sort(of_axis.begin(), of_axis.end());
      of_axis.erase(std::unique(of_axis.begin(), of_axis.end()), of_axis.end());
    }
    for (std::size_t v = 0; v < slots_.size(); ++v)
      for (std::size_t a = 0; a < 3; ++a)
        slots_[v][a] = slot(planes[a], &schedule.mesh_to_grid[4 * a], mesh.vertices[v]);
  }
  bool has(VertexId v) const {
    return std::any_of(slots_[v].begin(), slots_[v].end(), [](std::uint32_t s) { return s % 2 == 1; });
  }
  // True if the facet touches or crosses a plane.
  bool has(const std::array<VertexId, 3>& facet) const {
    return has(facet[0]) || slots_[facet[0]] != slots_[facet[1]] || slots_[facet[0]] != slots_[facet[2]];
  }

 private:
  // Returns twice the number of planes below, plus one on a plane. Four products and sums of doubles err by
  // less than 2^-50 of the terms' magnitudes. The millionth of a unit allows for coordinates rounded when
  // written.
  static std::uint32_t slot(const std::vector<double>& planes, const double* row, const Point& p) {
    const std::array<double, 4> terms{row[0] * p[0], row[1] * p[1], row[2] * p[2], row[3]};
    const double x = terms[0] + terms[1] + terms[2] + terms[3];
    const double size = std::fabs(terms[0]) + std::fabs(terms[1]) + std::fabs(terms[2]) + std::fabs(terms[3]);
    if (!std::isfinite(size)) return 1;  // open: counts as on a plane
    const double margin = 1e-6 + 0x1p-50 * size;
    const auto plane = std::lower_bound(planes.begin(), planes.end(), x - margin);
    const auto below = static_cast<std::uint32_t>(plane - planes.begin());
    return 2 * below + (plane != planes.end() && *plane <= x + margin);
  }

  std::vector<std::array<std::uint32_t, 3>> slots_;
};

struct Crossings {
  std::uint64_t facets = 0, with_one_cell = 0;
};
Crossings count_crossings(const Mesh& mesh, const Adjacency& adjacency, const LeafBoundaries& boundaries) {
  Crossings crossings;
  const IdRange own = own_facets(mesh);
  for (auto f = static_cast<FacetId>(own.begin); f < own.end; ++f) {
    if (adjacency.mirror[f] < f || !boundaries.has(vertices_of(mesh, f))) continue;
    ++crossings.facets;
    crossings.with_one_cell += adjacency.mirror[f] == kNone;
  }
  return {sum_over(ranks_of(mesh), crossings.facets), sum_over(ranks_of(mesh), crossings.with_one_cell)};
}

}  // namespace

ClaimResult check_conformity(const Mesh& mesh, const Adjacency& adjacency, const Schedule* schedule,
                             const Options&) {
  Tally tally;
  nlohmann::json details = nlohmann::json::object();
  const auto add_judged = [&](const char* name, const Tally& part) {
    details[name] = part.num_violations;
    tally.add(part);
  };
  const auto add = [&](const char* name, const Tally& own) { add_judged(name, over_ranks(mesh, own)); };
  const std::vector<FacetId> open_facets = facets_with_one_cell(mesh, adjacency);
  std::vector<VertexId> vertices;
  for (const FacetId f : open_facets)
    for (const VertexId v : vertices_of(mesh, f)) vertices.push_back(v);
  add("doubled_facets", check_facets(mesh, open_facets));
  add("doubled_vertices",
      check_coincident_vertices(mesh, std::move(vertices),
                                "vertices of boundary facets with the same coordinates are one vertex"));
  std::string about = fmt::format("{} facets with one cell", sum_over(ranks_of(mesh), open_facets.size()));
  if (schedule != nullptr) {
    const LeafBoundaries boundaries(mesh, *schedule);
    const std::vector<std::uint8_t> is_used = used_vertices(mesh);
    std::vector<VertexId> at_boundary;
    for (VertexId v = 0; v < mesh.vertices.size(); ++v)
      if (is_used[v] && owns_vertex(mesh, v) && boundaries.has(v)) at_boundary.push_back(v);
    add("doubled_vertices_at_leaf_boundaries",
        check_coincident_vertices(mesh, std::move(at_boundary),
                                  "vertices at a leaf boundary with the same coordinates are one vertex"));
    const Crossings crossings = count_crossings(mesh, adjacency, boundaries);
    details["facets_at_leaf_boundaries"] = crossings.facets;
    details["facets_at_leaf_boundaries_with_one_cell"] = crossings.with_one_cell;
    details["leaves"] = schedule->leaves.size();
    details["activations"] = schedule->activations.size();
    about += fmt::format(", {} facets at leaf boundaries, {} activations of {} leaves", crossings.facets,
                         schedule->activations.size(), schedule->leaves.size());
    tally.num_checked += crossings.facets;
    check_schedule(*schedule, add_judged);
  }
  ClaimResult result = result_of("conformity", tally);
  result.method = "equality of coordinates, integers on the leaf grid";
  result.details() = std::move(details);
  result.reason = fmt::format("{} violations; {}", result.num_violations, about);
  return result;
}

}  // namespace podm::verify
