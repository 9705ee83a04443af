#include "runtime/shortest_paths.h"

#include <algorithm>

namespace podm {

namespace {

// Builds the path backwards from `to`. `links` counts links from the start, `load` the paths through each
// vertex.
std::vector<int> path_to(const Neighbours& neighbours, const std::vector<int>& links, int to,
                         std::vector<int>& load) {
  std::vector<int> path = {to};
  while (links[path.back()] > 0) {
    const auto cost = [&](int vertex) { return std::pair(links[vertex], load[vertex]); };
    const std::vector<int>& before = neighbours[path.back()];
    path.push_back(
        *std::min_element(before.begin(), before.end(), [&](int a, int b) { return cost(a) < cost(b); }));
    ++load[path.back()];
  }
  --load[path.back()];  // the start is on all of its paths
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

std::vector<int> links_from(const Neighbours& neighbours, int start) {
  std::vector<int> links(neighbours.size(), -1), reached = {start};
  links[start] = 0;
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const int vertex = reached[next];
    for (const int neighbour : neighbours[vertex]) {
      if (links[neighbour] >= 0) continue;
      links[neighbour] = links[vertex] + 1;
      reached.push_back(neighbour);
    }
  }
  return links;
}

std::vector<std::vector<int>> shortest_paths(const Neighbours& neighbours, int num_ends) {
  std::vector<std::vector<int>> paths;
  std::vector<int> load(neighbours.size());
  for (int from = 0; from < num_ends; ++from) {
    const std::vector<int> links = links_from(neighbours, from);
    for (int to = 0; to < num_ends; ++to)
      paths.push_back(from == to ? std::vector<int>() : path_to(neighbours, links, to, load));
  }
  return paths;
}

}  // namespace podm
