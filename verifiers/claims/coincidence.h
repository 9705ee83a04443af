// Vertices and facets at the same place, wherever ranks hold them.
#pragma once

#include <bit>
#include <tuple>
#include <vector>

#include "claims/tally.h"

namespace podm::verify {

template <class Place>
struct Placed {
  Place place;
  GlobalId id;
};

/// Returns a number that is the same for equal points, also for 0 and -0.
inline std::uint64_t hash_of(const Point& point) {
  std::uint64_t hash = 0;
  for (const double x : point) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15;
    hash ^= hash >> 32;
  }
  return hash;
}

/// Collective. Brings the items of each place to one rank. Returns those of this rank, sorted by place, then
/// by id. `point_of` returns a point of a place, the same for equal places.
template <class Place, class PointOf>
std::vector<Placed<Place>> sorted_by_place(const Mesh& mesh, std::vector<Placed<Place>> items,
                                           const PointOf& point_of) {
  Communication& ranks = ranks_of(mesh);
  if (ranks.size() > 1) {
    auto lists = lists_for<Placed<Place>>(ranks);
    for (const Placed<Place>& item : items)
      lists[hash_of(point_of(item.place)) % lists.size()].push_back(item);
    items = exchange_joined(ranks, std::move(lists));
  }
  std::sort(items.begin(), items.end(),
            [](const auto& a, const auto& b) { return std::tie(a.place, a.id) < std::tie(b.place, b.id); });
  return items;
}

/// Collective. Finds vertices with the same coordinates. `vertices` may contain a vertex more than once, on
/// one rank or on several.
inline Tally check_coincident_vertices(const Mesh& mesh, const std::vector<VertexId>& vertices,
                                       const char* statement) {
  std::vector<Placed<Point>> placed;
  placed.reserve(vertices.size());
  for (const VertexId v : vertices) placed.push_back({mesh.vertices[v], global_vertex(mesh, v)});
  placed = sorted_by_place(mesh, std::move(placed), [](const Point& point) { return point; });
  placed.erase(
      std::unique(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.id == b.id; }),
      placed.end());
  Tally tally;
  tally.num_checked = placed.size();
  for (std::size_t i = 0; i + 1 < placed.size(); ++i) {
    if (placed[i].place != placed[i + 1].place) continue;
    tally.violation(
        {.statement = statement, .vertices = {placed[i].id, placed[i + 1].id}, .points = {placed[i].place}});
  }
  return tally;
}

}  // namespace podm::verify
