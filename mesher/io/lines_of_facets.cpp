#include "io/lines_of_facets.h"

#include <algorithm>
#include <array>
#include <compare>
#include <map>

namespace podm {
namespace {

using Edge = std::array<std::uint32_t, 2>;
using Labels = std::vector<LabelIndex>;

constexpr std::size_t kLeastLabels = 3;

// An edge of a facet, and one of the two labels that the facet separates.
struct LabelAtEdge {
  Edge edge;
  LabelIndex label;
  auto operator<=>(const LabelAtEdge&) const = default;
};

// All labels around an edge are on the sides of the facets around it. Sorted, without repetitions.
std::vector<LabelAtEdge> labels_at_edges(const TetMesh& mesh) {
  std::vector<LabelAtEdge> all;
  all.reserve(6 * mesh.facets.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [first, second] = std::minmax(mesh.facets[f][i], mesh.facets[f][(i + 1) % 3]);
      for (const LabelIndex label : mesh.facet_labels[f]) all.push_back({{first, second}, label});
    }
  }
  std::ranges::sort(all);
  const auto repeated = std::ranges::unique(all);
  all.erase(repeated.begin(), repeated.end());
  return all;
}

}  // namespace

MeshLines lines_of_facets(const TetMesh& mesh, double delta_mm) {
  MeshLines lines;
  lines.delta_mm = delta_mm;
  std::map<Labels, std::uint32_t> numbers;
  const std::vector<LabelAtEdge> all = labels_at_edges(mesh);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    Labels labels;
    for (; end < all.size() && all[end].edge == all[begin].edge; ++end) labels.push_back(all[end].label);
    if (labels.size() < kLeastLabels) continue;
    const auto [line, is_new] = numbers.try_emplace(labels, static_cast<std::uint32_t>(numbers.size()));
    if (is_new) lines.labels_of_line.push_back(labels);
    lines.edges.push_back(all[begin].edge);
    lines.line_of_edge.push_back(line->second);
  }
  return lines;
}

}  // namespace podm
