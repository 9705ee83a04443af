// Searches for points of an image's labels near a point, by the label function's exact decisions.
//
// A point that is found is a proof. If none is found, nothing is proved, unless weights are too far apart for
// their slopes, which ends the search at once, except at the sides of a flat box, where weights jump.
// Otherwise the search probes the segments from the point along the gradient of the weights that matter
// there, and along the axes and diagonals of voxels. On a segment that meets the label it bisects to the
// first point of the label.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "image/label_function.h"

namespace podm::verify {

/// Points and lengths are in voxel indices.
class LabelSearch {
 public:
  /// Keeps a reference to the image.
  explicit LabelSearch(const Image& image) : function_(image) {}

  struct Found {
    Point at{};
    std::uint32_t label = 0;
    double distance = 0;  ///< rounded
  };
  using Wanted = std::function<bool(std::uint32_t)>;
  /// Returns a point within `reach` of u whose label is wanted, decided exactly. The label at u must not be
  /// wanted.
  std::optional<Found> find(const Point& u, const Wanted& wanted, double reach,
                            std::uint64_t& num_exact) const;
  std::uint32_t label_at(const Point& u, std::uint64_t& num_exact) const {
    return function_.decided_label_at(u, num_exact);
  }

 private:
  std::optional<Found> along(const Point& u, const Point& direction, const Wanted& wanted, double reach,
                             std::uint64_t& num_exact) const;
  // The greatest weight at u of a wanted label, and the greatest of another label; 0 if there is none.
  struct Rivals {
    std::optional<std::uint32_t> wanted, other;
    double wanted_weight = 0, other_weight = 0;
    bool is_alone = false;  // one label has all the weight
  };
  Rivals rivals(const Point& u, const Wanted& wanted) const;
  static bool is_out_of_reach(const Rivals& rivals, double reach);

  LabelFunction function_;
};

}  // namespace podm::verify
