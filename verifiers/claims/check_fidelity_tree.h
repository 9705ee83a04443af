// Finds the nearest of many shapes by a tree of boxes, split at the median of the longest side.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "mesh.h"

namespace podm::verify {

struct Nearest {
  std::uint32_t shape = kNone;
  Point point{};  ///< nearest point of the shape
  double squared = std::numeric_limits<double>::infinity();
};

inline double squared_distance(const Point& a, const Point& b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

/// Shapes must have `Point closest(shape, p)` and `void bounds(shape, low, high)`.
template <class Shapes>
class NearestTree {
 public:
  /// Keeps a reference to `shapes`.
  NearestTree(const Shapes& shapes, std::vector<std::uint32_t> ids) : shapes_(&shapes), ids_(std::move(ids)) {
    if (ids_.empty()) return;
    nodes_.reserve(4 * ids_.size() / kLeafSize + 1);
    build(0, static_cast<std::uint32_t>(ids_.size()));
  }

  bool empty() const { return ids_.empty(); }

  /// Replaces `best` if a shape is nearer to p. A good first guess saves time.
  void improve(const Point& p, Nearest& best) const {
    if (!ids_.empty()) visit(0, p, best);
  }
  void try_shape(std::uint32_t shape, const Point& p, Nearest& best) const {
    const Point q = shapes_->closest(shape, p);
    const double squared = squared_distance(p, q);
    if (squared < best.squared) best = {shape, q, squared};
  }

 private:
  static constexpr std::uint32_t kLeafSize = 8;
  struct Node {
    Point low, high;
    std::uint32_t begin, end, right;  // right child (the left child is the next node); 0: a leaf
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(bounded(begin, end));
    if (end - begin <= kLeafSize) return index;
    const Point extent{nodes_[index].high[0] - nodes_[index].low[0],
                       nodes_[index].high[1] - nodes_[index].low[1],
                       nodes_[index].high[2] - nodes_[index].low[2]};
    const auto axis =
        static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(ids_.begin() + begin, ids_.begin() + middle, ids_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return center(a, axis) < center(b, axis); });
    build(begin, middle);
    const std::uint32_t right = build(middle, end);
    nodes_[index].right = right;
    return index;
  }

  double center(std::uint32_t shape, std::size_t axis) const {
    Point low, high;
    shapes_->bounds(shape, low, high);
    return low[axis] + high[axis];
  }

  Node bounded(std::uint32_t begin, std::uint32_t end) const {
    Node node{{}, {}, begin, end, 0};
    shapes_->bounds(ids_[begin], node.low, node.high);
    for (std::uint32_t i = begin + 1; i < end; ++i) {
      Point low, high;
      shapes_->bounds(ids_[i], low, high);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis] = std::min(node.low[axis], low[axis]);
        node.high[axis] = std::max(node.high[axis], high[axis]);
      }
    }
    return node;
  }

  static double squared_to_box(const Node& node, const Point& p) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = std::max({node.low[axis] - p[axis], p[axis] - node.high[axis], 0.0});
      sum += d * d;
    }
    return sum;
  }

  void visit(std::uint32_t index, const Point& p, Nearest& best) const {
    const Node& node = nodes_[index];
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) try_shape(ids_[i], p, best);
      return;
    }
    std::array<std::uint32_t, 2> children{index + 1, node.right};
    std::array<double, 2> squared{squared_to_box(nodes_[children[0]], p),
                                  squared_to_box(nodes_[children[1]], p)};
    if (squared[1] < squared[0]) {
      std::swap(children[0], children[1]);
      std::swap(squared[0], squared[1]);
    }
    for (std::size_t c = 0; c < 2; ++c)
      if (squared[c] < best.squared) visit(children[c], p, best);
  }

  const Shapes* shapes_;
  std::vector<std::uint32_t> ids_;
  std::vector<Node> nodes_;
};

}  // namespace podm::verify
