// Claim conformity.
//   Statements  across label interfaces, and with a schedule across leaf boundaries too: no two facets with
//   one cell
//               each lie at the same place, and no two vertices there have the same coordinates; that is, the
//               parts that were made apart share their facets. With a schedule: no two leaves that were
//               active at the same time are within two rings of each other, and no operation touched a vertex
//               outside its leaf and the first ring.
//   Rests on    equality of coordinates. Rings are those of the leaf grid: leaves whose closed cubes meet.
//   Which
//               vertices lie at a leaf boundary is decided with a margin far above rounding, so some more are
//               looked at. The schedule is the mesher's own word on what it did when.
//   Cost        linear, and in the schedule the activations times those active beside them.
//   Not proved  that facets which only partly coincide are matched: the structure claim finds those as
//   hanging vertices
//               and overlaps.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "claims/claims.h"
#include "claims/tally.h"

namespace podm::verify {

namespace {

using FacetPoints = std::array<Point, 3>;

// Boundary facets by where they are, whatever their vertices' ids.
Tally check_unmatched_facets(const Mesh& mesh, const Adjacency& adjacency) {
  struct Facet {
    FacetPoints points;
    FacetId id;
  };
  std::vector<Facet> facets;
  for (FacetId f = 0; f < adjacency.mirror.size(); ++f) {
    if (adjacency.mirror[f] != kNone) continue;
    Facet& facet = facets.emplace_back();
    facet.id = f;
    for (std::size_t k = 0; k < 3; ++k)
      facet.points[k] = mesh.vertices[mesh.cells[f / 4][static_cast<std::size_t>(kFacetVertices[f % 4][k])]];
    std::sort(facet.points.begin(), facet.points.end());
  }
  std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return std::tie(a.points, a.id) < std::tie(b.points, b.id);
  });
  Tally tally;
  tally.num_checked = facets.size();
  for (std::size_t i = 0; i + 1 < facets.size(); ++i) {
    if (facets[i].points != facets[i + 1].points) continue;
    tally.violation({.statement = "facets at the same place are one facet",
                     .cells = {facets[i].id / 4, facets[i + 1].id / 4},
                     .points = {facets[i].points.begin(), facets[i].points.end()}});
  }
  return tally;
}

class LeafGrid {
 public:
  explicit LeafGrid(const Schedule& schedule) : schedule_(schedule) {}

  // Whether a point lies on a face of some leaf, within a margin of 1e-6 of the smallest side.
  bool is_at_boundary(const Point& p) const {
    constexpr double kMargin = 1e-6;
    for (std::size_t a = 0; a < 3; ++a) {
      const double* row = &schedule_.mesh_to_grid[4 * a];
      const double x = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
      if (std::fabs(x - std::round(x)) <= kMargin) return true;
    }
    return false;
  }
  bool touch(std::uint32_t a, std::uint32_t b) const {
    const Leaf &p = schedule_.leaves[a], &q = schedule_.leaves[b];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (p.corner[axis] > q.corner[axis] + q.side || q.corner[axis] > p.corner[axis] + p.side) return false;
    }
    return true;
  }
  // A leaf between the two touches both, or they touch each other.
  bool are_within_two_rings(std::uint32_t a, std::uint32_t b) const {
    if (touch(a, b)) return true;
    for (const std::uint32_t between : neighbors(a))
      if (touch(between, b)) return true;
    return false;
  }
  const std::vector<std::uint32_t>& neighbors(std::uint32_t leaf) const {
    const auto [found, is_new] = neighbors_.try_emplace(leaf);
    if (is_new) {
      for (std::uint32_t other = 0; other < schedule_.leaves.size(); ++other)
        if (other != leaf && touch(leaf, other)) found->second.push_back(other);
    }
    return found->second;
  }

 private:
  const Schedule& schedule_;
  mutable std::map<std::uint32_t, std::vector<std::uint32_t>> neighbors_;
};

Tally check_coincident_vertices(const Mesh& mesh, const LeafGrid& grid) {
  std::vector<VertexId> at_boundary;
  for (VertexId v = 0; v < mesh.vertices.size(); ++v)
    if (grid.is_at_boundary(mesh.vertices[v])) at_boundary.push_back(v);
  std::sort(at_boundary.begin(), at_boundary.end(), [&](VertexId a, VertexId b) {
    return std::tie(mesh.vertices[a], a) < std::tie(mesh.vertices[b], b);
  });
  Tally tally;
  tally.num_checked = at_boundary.size();
  for (std::size_t i = 0; i + 1 < at_boundary.size(); ++i) {
    if (mesh.vertices[at_boundary[i]] != mesh.vertices[at_boundary[i + 1]]) continue;
    tally.violation({.statement = "no vertex is doubled along a leaf boundary",
                     .vertices = {at_boundary[i], at_boundary[i + 1]},
                     .points = {mesh.vertices[at_boundary[i]]}});
  }
  return tally;
}

// A sweep over time; intervals are closed at their beginning and open at their end.
Tally check_rings(const Schedule& schedule, const LeafGrid& grid) {
  std::vector<const Activation*> by_begin;
  for (const Activation& a : schedule.activations) by_begin.push_back(&a);
  std::sort(by_begin.begin(), by_begin.end(),
            [](const Activation* a, const Activation* b) { return a->begin_s < b->begin_s; });
  std::vector<const Activation*> active;
  Tally tally;
  for (const Activation* a : by_begin) {
    std::erase_if(active, [&](const Activation* b) { return b->end_s <= a->begin_s; });
    for (const Activation* b : active) {
      ++tally.num_checked;
      if (!grid.are_within_two_rings(a->leaf, b->leaf)) continue;
      tally.violation(
          {.statement = fmt::format("leaves {} and {}, active together at {} s, are two rings apart", b->leaf,
                                    a->leaf, a->begin_s)});
    }
    if (a->end_s > a->begin_s) active.push_back(a);
  }
  return tally;
}

Tally check_touched_leaves(const Schedule& schedule, const LeafGrid& grid) {
  Tally tally;
  for (const Activation& a : schedule.activations) {
    for (const std::uint32_t touched : a.touched_leaves) {
      ++tally.num_checked;
      if (touched == a.leaf || grid.touch(a.leaf, touched)) continue;
      tally.violation(
          {.statement = fmt::format("operations of leaf {} at {} s keep to it and its first ring, not {}",
                                    a.leaf, a.begin_s, touched)});
    }
  }
  return tally;
}

}  // namespace

ClaimResult check_conformity(const Mesh& mesh, const Adjacency& adjacency, const Schedule* schedule,
                             const Options&) {
  Tally tally = check_unmatched_facets(mesh, adjacency);
  nlohmann::json details = {{"unmatched_facets", tally.num_violations}};
  if (schedule != nullptr) {
    const LeafGrid grid(*schedule);
    const auto add = [&](const char* name, const Tally& part) {
      details[name] = part.num_violations;
      tally.add(part);
    };
    add("doubled_vertices", check_coincident_vertices(mesh, grid));
    add("leaves_too_near", check_rings(*schedule, grid));
    add("leaves_touched_outside", check_touched_leaves(*schedule, grid));
    details["leaves"] = schedule->leaves.size();
    details["activations"] = schedule->activations.size();
  }
  ClaimResult result = result_of("conformity", tally);
  result.method = "equality of coordinates, integer arithmetic on the leaf grid";
  result.details = std::move(details);
  result.reason =
      fmt::format("{} violations among {} boundary facets", result.num_violations, result.num_checked);
  if (schedule != nullptr)
    result.reason = fmt::format("{} violations; {} activations of {} leaves", result.num_violations,
                                schedule->activations.size(), schedule->leaves.size());
  return result;
}

}  // namespace podm::verify
