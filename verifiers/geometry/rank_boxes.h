// The boxes of what ranks hold: which ranks to ask about a place.
#pragma once

#include <vector>

#include "geometry/box_tree.h"
#include "ranks/part.h"

namespace podm::verify {

class RankBoxes {
 public:
  /// Collective. `own` is this rank's box; a box of nothing is kEmptyBounds.
  RankBoxes(const Mesh& mesh, const Bounds& own) : RankBoxes(gather(ranks_of(mesh), own), mesh) {}

  /// Calls visit(rank) for every other rank whose box `meets` (BoxTree::for_each_near).
  template <class Meets, class Visit>
  void for_each_other(const Meets& meets, const Visit& visit) const {
    tree_.for_each_near(meets, [&](std::uint32_t i) {
      if (meets(boxes_[i])) visit(ranks_[i]);
    });
  }

 private:
  RankBoxes(const std::vector<Bounds>& all, const Mesh& mesh)
      : ranks_(others_with_box(all, static_cast<std::size_t>(ranks_of(mesh).rank()))),
        boxes_(boxes_of(all, ranks_)),
        tree_(boxes_) {}

  static std::vector<std::size_t> others_with_box(const std::vector<Bounds>& all, std::size_t own) {
    std::vector<std::size_t> ranks;
    for (std::size_t r = 0; r < all.size(); ++r)
      if (r != own && all[r].low[0] <= all[r].high[0]) ranks.push_back(r);
    return ranks;
  }
  static std::vector<Bounds> boxes_of(const std::vector<Bounds>& all, const std::vector<std::size_t>& ranks) {
    std::vector<Bounds> boxes;
    for (const std::size_t r : ranks) boxes.push_back(all[r]);
    return boxes;
  }

  std::vector<std::size_t> ranks_;
  std::vector<Bounds> boxes_;
  BoxTree tree_;
};

}  // namespace podm::verify
