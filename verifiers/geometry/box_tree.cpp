#include "geometry/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace podm::verify {

BoxTree::BoxTree(const std::vector<Bounds>& boxes) : ids_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(ids_.begin(), ids_.end(), 0U);
  build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
}

std::uint32_t BoxTree::build(const std::vector<Bounds>& boxes, std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Bounds all = boxes[ids_[begin]];
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    const Bounds& box = boxes[ids_[i]];
    for (std::size_t a = 0; a < 3; ++a) {
      all.low[a] = std::min(all.low[a], box.low[a]);
      all.high[a] = std::max(all.high[a], box.high[a]);
    }
  }
  nodes_.push_back({all, begin, end, 0});
  if (end - begin <= kLeafSize) return index;
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (all.high[a] - all.low[a] > all.high[axis] - all.low[axis]) axis = a;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(ids_.begin() + begin, ids_.begin() + middle, ids_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return boxes[a].low[axis] / 2 + boxes[a].high[axis] / 2 <
                            boxes[b].low[axis] / 2 + boxes[b].high[axis] / 2;
                   });
  build(boxes, begin, middle);
  const std::uint32_t right = build(boxes, middle, end);
  nodes_[index].right = right;
  return index;
}

std::vector<Bounds> BoxTree::boxes_at(std::size_t levels) const {
  std::vector<Bounds> boxes;
  std::vector<std::pair<std::uint32_t, std::size_t>> stack;  // nodes, and the levels below them
  if (!nodes_.empty()) stack.emplace_back(0, levels);
  while (!stack.empty()) {
    const auto [index, below] = stack.back();
    stack.pop_back();
    const Node& node = nodes_[index];
    if (below == 0 || node.right == 0) {
      boxes.push_back(node.box);
    } else {
      stack.emplace_back(node.right, below - 1);
      stack.emplace_back(index + 1, below - 1);
    }
  }
  return boxes;
}

}  // namespace podm::verify
