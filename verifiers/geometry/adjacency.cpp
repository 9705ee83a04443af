#include "geometry/adjacency.h"

#include <algorithm>
#include <utility>

#include "parallel.h"

namespace podm::verify {

namespace {

std::array<VertexId, 3> sorted_vertices(const Mesh& mesh, FacetId f) {
  std::array<VertexId, 3> v = vertices_of(mesh, f);
  if (v[0] > v[1]) std::swap(v[0], v[1]);
  if (v[1] > v[2]) std::swap(v[1], v[2]);
  if (v[0] > v[1]) std::swap(v[0], v[1]);
  return v;
}

// The facets grouped by smallest vertex: those of vertex v are facets[start[v]] to facets[start[v + 1]].
struct FacetsByVertex {
  std::vector<std::size_t> start;
  std::vector<FacetId> facets;
};

FacetsByVertex group_by_smallest_vertex(const Mesh& mesh) {
  FacetsByVertex groups;
  const auto num_facets = static_cast<FacetId>(4 * mesh.cells.size());
  groups.start.assign(mesh.vertices.size() + 2, 0);
  for (FacetId f = 0; f < num_facets; ++f) ++groups.start[sorted_vertices(mesh, f)[0] + 2];
  for (std::size_t v = 2; v < groups.start.size(); ++v) groups.start[v] += groups.start[v - 1];
  groups.facets.resize(num_facets);
  for (FacetId f = 0; f < num_facets; ++f) groups.facets[groups.start[sorted_vertices(mesh, f)[0] + 1]++] = f;
  groups.start.pop_back();
  return groups;
}

}  // namespace

Adjacency find_adjacency(const Mesh& mesh, int threads) {
  const FacetsByVertex groups = group_by_smallest_vertex(mesh);
  Adjacency adjacency;
  adjacency.mirror.assign(4 * mesh.cells.size(), kNone);
  std::vector<std::vector<std::vector<FacetId>>> crowded(static_cast<std::size_t>(std::max(threads, 1)));
  parallel_ranges(mesh.vertices.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    std::vector<std::pair<std::array<VertexId, 3>, FacetId>> around;
    for (std::size_t v = begin; v < end; ++v) {
      around.clear();
      for (std::size_t i = groups.start[v]; i < groups.start[v + 1]; ++i)
        around.emplace_back(sorted_vertices(mesh, groups.facets[i]), groups.facets[i]);
      std::sort(around.begin(), around.end());
      for (std::size_t first = 0, last; first < around.size(); first = last) {
        for (last = first + 1; last < around.size() && around[last].first == around[first].first;) ++last;
        if (last - first == 2) {
          adjacency.mirror[around[first].second] = around[first + 1].second;
          adjacency.mirror[around[first + 1].second] = around[first].second;
        } else if (last - first > 2) {
          std::vector<FacetId>& group = crowded[thread].emplace_back();
          for (std::size_t i = first; i < last; ++i) group.push_back(around[i].second);
        }
      }
    }
  });
  for (auto& part : crowded) std::move(part.begin(), part.end(), std::back_inserter(adjacency.crowded));
  return adjacency;
}

std::vector<std::uint8_t> used_vertices(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto& cell : mesh.cells)
    for (const VertexId v : cell) used[v] = 1;
  return used;
}

}  // namespace podm::verify
