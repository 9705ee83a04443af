// Cavities of regions, from the places where regions touch.
//
// The nodes are pieces of space with one label each: of an image or of a mesh, and everything around it.
// Pieces of one label make up regions. The cavities of a region are the components of the rest of its label
// that it borders on, all but one: in space, what separates the components of a label from those of the rest
// forms a tree, and a region has one neighbor in it towards the outside.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh.h"

namespace podm::verify {

/// Union-find over numbers.
class NumberSets {
 public:
  explicit NumberSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) { parent_[root(i)] = root(j); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// A component of a label, and its Betti numbers.
struct LabelRegion {
  LabelValue label = 0;
  std::uint64_t size = 0;  ///< voxels or cells
  std::int64_t euler = 0, cavities = 0;
  std::int64_t handles() const { return 1 + cavities - euler; }
};

class RegionGraph {
 public:
  static constexpr LabelValue kAll = -1;

  explicit RegionGraph(std::vector<LabelValue> label_of_piece) : label_of_(std::move(label_of_piece)) {}

  /// The pieces have a face in common.
  void border(std::uint32_t a, std::uint32_t b) { borders_.insert({std::min(a, b), std::max(a, b)}); }
  /// The pieces touch, so that they are one for the rest of every label but theirs, and but `except`.
  void touch(std::uint32_t a, std::uint32_t b, LabelValue except = kAll) {
    touches_.insert({std::min(a, b), std::max(a, b), except});
  }
  /// The pieces are one for the rest of this label alone.
  void touch_for(std::uint32_t a, std::uint32_t b, LabelValue label) {
    touches_for_.insert({std::min(a, b), std::max(a, b), label});
  }
  /// Sets the cavities of regions. `region_of` are the regions of pieces; kNone for those of the rest.
  void count_cavities(const std::vector<std::uint32_t>& region_of, std::vector<LabelRegion>& regions) const;

 private:
  std::vector<LabelValue> label_of_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> borders_;
  std::set<std::tuple<std::uint32_t, std::uint32_t, LabelValue>> touches_, touches_for_;
};

}  // namespace podm::verify
