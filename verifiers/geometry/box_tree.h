// A tree over axis-aligned boxes, split at medians, that finds the boxes that may meet a region.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "mesh.h"

namespace podm::verify {

struct Bounds {
  Point low{}, high{};
};
template <class Points>
Bounds bounds_of(const Points& points) {
  Bounds box{points[0], points[0]};
  for (const Point& p : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] < box.low[a]) box.low[a] = p[a];
      if (p[a] > box.high[a]) box.high[a] = p[a];
    }
  }
  return box;
}
inline constexpr double kBeyondAll = std::numeric_limits<double>::infinity();
/// Contains nothing and meets nothing.
inline constexpr Bounds kEmptyBounds{{kBeyondAll, kBeyondAll, kBeyondAll},
                                     {-kBeyondAll, -kBeyondAll, -kBeyondAll}};
/// Returns the box of both boxes.
inline Bounds joined(const Bounds& a, const Bounds& b) {
  Bounds box = a;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(a.low[axis], b.low[axis]);
    box.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return box;
}
inline bool meet(const Bounds& a, const Bounds& b) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
  return true;
}

/// Takes about 14 bytes per box, however the boxes are spread. The boxes must be finite.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Bounds>& boxes);

  /// Returns at most 2^levels boxes that hold all: the boxes of the nodes at depth `levels`, and of the
  /// leaves at lesser depth.
  std::vector<Bounds> boxes_at(std::size_t levels) const;

  /// Calls visit(i) once for every box i of the leaves whose box `meets`. The function `meets` must be true
  /// for every box that contains a box for which it is true.
  template <class Meets, class Visit>
  void for_each_near(const Meets& meets, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, 64> stack;  // one entry per level; boxes halve per level
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const std::uint32_t index = stack[--size];
      const Node& node = nodes_[index];
      if (!meets(node.box)) continue;
      if (node.right == 0) {
        for (std::uint32_t i = node.begin; i < node.end; ++i) visit(ids_[i]);
      } else {
        stack[size++] = node.right;
        stack[size++] = index + 1;
      }
    }
  }

  /// Calls visit(i) once for every box i of the leaves whose box's `distance` is at most `limit`. A visit may
  /// lower `limit`. `distance` must not be greater for a box than for a box that it contains. The nearer of
  /// two branches is visited first.
  template <class Distance, class Visit>
  void for_each_within(const double& limit, const Distance& distance, const Visit& visit) const {
    if (nodes_.empty()) return;
    struct Branch {
      std::uint32_t index;
      double distance;
    };
    const auto branch = [&](std::uint32_t index) { return Branch{index, distance(nodes_[index].box)}; };
    std::array<Branch, 64> stack;  // one entry per level; boxes halve per level
    std::size_t size = 0;
    stack[size++] = branch(0);
    while (size > 0) {
      const auto [index, far] = stack[--size];
      if (far > limit) continue;
      const Node& node = nodes_[index];
      if (node.right == 0) {
        for (std::uint32_t i = node.begin; i < node.end; ++i) visit(ids_[i]);
      } else {
        const Branch left = branch(index + 1), right = branch(node.right);
        const bool is_left_nearer = left.distance < right.distance;
        stack[size++] = is_left_nearer ? right : left;
        stack[size++] = is_left_nearer ? left : right;
      }
    }
  }

 private:
  static constexpr std::uint32_t kLeafSize = 16;
  struct Node {
    Bounds box;
    std::uint32_t begin, end, right;  // right child (the left child is the next node); 0: a leaf
  };
  std::uint32_t build(const std::vector<Bounds>& boxes, std::uint32_t begin, std::uint32_t end);

  std::vector<std::uint32_t> ids_;
  std::vector<Node> nodes_;
};

}  // namespace podm::verify
