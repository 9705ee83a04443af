#include "lines/line_network.h"

namespace podm {

LineNetwork part_of(const LineNetwork& network, const std::function<bool(const LineArc&)>& is_wanted) {
  LineNetwork part;
  part.undecided = network.undecided;
  part.removed_voxels = network.removed_voxels;
  part.is_whole = network.is_whole;
  std::vector<std::int32_t> number(network.nodes.size(), -1);
  for (const LineArc& arc : network.arcs) {
    if (!is_wanted(arc)) continue;
    part.arcs.push_back(arc);
    for (std::int32_t* end : {&part.arcs.back().first_node, &part.arcs.back().last_node})
      if (*end >= 0) number[static_cast<std::size_t>(*end)] = 0;
  }
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    number[n] = static_cast<std::int32_t>(part.nodes.size());
    part.nodes.push_back(network.nodes[n]);
  }
  for (LineArc& arc : part.arcs)
    for (std::int32_t* end : {&arc.first_node, &arc.last_node})
      if (*end >= 0) *end = number[static_cast<std::size_t>(*end)];
  return part;
}

}  // namespace podm
