// The boxes of what ranks hold: which ranks to ask about a place.
#pragma once

#include <algorithm>
#include <vector>

#include "geometry/box_tree.h"
#include "ranks/part.h"

namespace podm::verify {

/// A rank's pieces may be far apart. One box would then hold much that the rank does not, so a rank has some
/// boxes.
inline constexpr std::size_t kLevelsOfRankBoxes = 6, kBoxesOfRank = std::size_t{1} << kLevelsOfRankBoxes;

/// Returns the boxes of at most kBoxesOfRank ranges of the items 0 to count - 1. Box_of(i) may be
/// kEmptyBounds.
template <class BoxOf>
std::vector<Bounds> boxes_of_ranges(std::size_t count, const BoxOf& box_of) {
  std::vector<Bounds> boxes;
  for (std::size_t range = 0; range < kBoxesOfRank; ++range) {
    Bounds box = kEmptyBounds;
    for (std::size_t i = count * range / kBoxesOfRank; i < count * (range + 1) / kBoxesOfRank; ++i)
      box = joined(box, box_of(i));
    if (box.low[0] <= box.high[0]) boxes.push_back(box);
  }
  return boxes;
}

class RankBoxes {
 public:
  /// Collective. `own` are this rank's boxes.
  RankBoxes(Communication& ranks, const std::vector<Bounds>& own)
      : RankBoxes(gather(ranks, own), static_cast<std::size_t>(ranks.rank())) {}

  /// Calls visit(rank) once for every other rank with a box that `meets` (BoxTree::for_each_near).
  template <class Meets, class Visit>
  void for_each_other(const Meets& meets, const Visit& visit) const {
    std::vector<std::size_t> met;
    tree_.for_each_near(meets, [&](std::uint32_t i) {
      if (std::find(met.begin(), met.end(), ranks_[i]) == met.end() && meets(boxes_[i]))
        met.push_back(ranks_[i]);
    });
    for (const std::size_t rank : met) visit(rank);
  }

 private:
  RankBoxes(const std::vector<std::vector<Bounds>>& all, std::size_t own)
      : boxes_(boxes_of_others(all, own, ranks_)), tree_(boxes_) {}

  // Also sets the ranks of the boxes.
  static std::vector<Bounds> boxes_of_others(const std::vector<std::vector<Bounds>>& all, std::size_t own,
                                             std::vector<std::size_t>& ranks) {
    std::vector<Bounds> boxes;
    for (std::size_t r = 0; r < all.size(); ++r) {
      if (r == own) continue;
      boxes.insert(boxes.end(), all[r].begin(), all[r].end());
      ranks.resize(boxes.size(), r);
    }
    return boxes;
  }

  std::vector<std::size_t> ranks_;
  std::vector<Bounds> boxes_;
  BoxTree tree_;
};

}  // namespace podm::verify
