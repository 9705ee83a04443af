#include "claims/region_graph.h"

namespace podm::verify {

void RegionGraph::count_cavities(const std::vector<std::uint32_t>& region_of,
                                 std::vector<LabelRegion>& regions) const {
  std::set<LabelValue> labels;
  for (const LabelRegion& region : regions) labels.insert(region.label);
  for (const LabelValue label : labels) {
    NumberSets rest(label_of_.size());
    for (const auto& [a, b, except] : touches_)
      if (label_of_[a] != label && label_of_[b] != label && except != label) rest.unite(a, b);
    for (const auto& [a, b, only] : touches_for_)
      if (only == label) rest.unite(a, b);
    std::set<std::pair<std::uint32_t, std::uint32_t>> neighbors;  // a region and a component of the rest
    for (auto [a, b] : borders_) {
      if (label_of_[b] == label) std::swap(a, b);
      if (label_of_[a] == label && label_of_[b] != label) neighbors.insert({region_of[a], rest.root(b)});
    }
    for (const auto& [region, component] : neighbors) ++regions[region].cavities;
    for (LabelRegion& region : regions) region.cavities -= region.label == label;
  }
}

}  // namespace podm::verify
