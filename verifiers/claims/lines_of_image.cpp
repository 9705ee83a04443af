#include "claims/lines_of_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "parallel.h"

namespace podm::verify {

namespace {

// Boxes are not cut in the middle: interfaces of an image that is not smoothed often lie there, and labels
// then tie at the corners of boxes.
constexpr double kLowerShare = 0.46;
constexpr int kCuts = 5;
constexpr std::size_t kFewestLabels = 3;

using Corners = std::array<double, 8>;

struct Box {
  Point low{}, high{};  // in the block, 0 to 1

  Point center() const {
    return {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
  }
  Box part(std::size_t octant) const {
    Box part = *this;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cut = low[axis] + kLowerShare * (high[axis] - low[axis]);
      ((octant >> axis & 1) != 0 ? part.low : part.high)[axis] = cut;
    }
    return part;
  }
};

// A label that may be greatest in a box, and its weights at the corners.
struct InBox {
  std::uint32_t label;
  Corners weights;
};

// Returns the weights at the corners of one of the eight parts of a box. Along an axis a trilinear function
// is linear.
Corners in_part(Corners weights, std::size_t octant) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t step = std::size_t{1} << axis;
    for (std::size_t c = 0; c < 8; ++c) {
      if ((c & step) != 0) continue;
      const double cut = weights[c] + kLowerShare * (weights[c + step] - weights[c]);
      weights[(octant & step) != 0 ? c : c + step] = cut;
    }
  }
  return weights;
}

// The slack exceeds what rounding adds up to in all cuts.
bool is_below(const Corners& a, const Corners& b) {
  constexpr double kSlack = 16 * LabelFunction::kWeightError;
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return x < y - kSlack; });
}

// Returns the labels that no other one exceeds at all corners, in the same order.
std::vector<InBox> not_below(const std::vector<InBox>& labels) {
  std::vector<InBox> left;
  std::copy_if(labels.begin(), labels.end(), std::back_inserter(left), [&](const InBox& one) {
    return std::none_of(labels.begin(), labels.end(),
                        [&](const InBox& other) { return is_below(one.weights, other.weights); });
  });
  return left;
}

class BlockSearch {
 public:
  BlockSearch(const LabelFunction& function, const ImageFrame& frame, std::vector<LinePoint>& points)
      : function_(function), frame_(frame), points_(points) {}

  void search(const std::array<int, 3>& block) { search(block, function_.corners(block)); }

  // Searches the plane of the low or the high side along an axis. `block` begins at the outermost centers.
  void search_side(const std::array<int, 3>& block, std::size_t axis, bool is_high) {
    auto labels = function_.corners(block);
    for (std::size_t c = 0; c < 8; ++c)
      if (((c >> axis & 1) != 0) == is_high) labels[c] = 0;
    axis_ = axis;
    plane_ = block[axis] + 0.5;
    search(block, labels);
    plane_.reset();
  }

 private:
  void search(const std::array<int, 3>& block, const std::array<std::uint32_t, 8>& labels) {
    auto distinct = labels;
    std::sort(distinct.begin(), distinct.end());
    const auto end = std::unique(distinct.begin(), distinct.end());
    if (static_cast<std::size_t>(end - distinct.begin()) < kFewestLabels) return;
    const auto voxel_weights = function_.voxel_weights(block);
    std::vector<InBox> in_block;
    for (auto label = distinct.begin(); label != end; ++label) {
      in_block.push_back({*label, {}});
      for (std::size_t c = 0; c < 8; ++c)
        if (labels[c] == *label)
          in_block.back().weights[c] = static_cast<double>(voxel_weights[c]) / kFullVoxelWeight;
    }
    block_ = block;
    divide({{0, 0, 0}, {1, 1, 1}}, in_block, kCuts);
  }

  void divide(const Box& box, const std::vector<InBox>& all, int cuts_left) {
    const std::vector<InBox> labels = not_below(all);
    if (labels.size() < kFewestLabels) return;
    if (cuts_left == 0) return add(box, labels);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      std::vector<InBox> in_octant = labels;
      for (InBox& one : in_octant) one.weights = in_part(one.weights, octant);
      divide(box.part(octant), in_octant, cuts_left - 1);
    }
  }

  // The smaller label wins a tie.
  void add(const Box& box, const std::vector<InBox>& labels) {
    std::vector<bool> is_greatest(labels.size());
    for (std::size_t c = 0; c < 8; ++c) {
      const auto best = std::max_element(labels.begin(), labels.end(), [&](const InBox& a, const InBox& b) {
        return a.weights[c] < b.weights[c];
      });
      is_greatest[static_cast<std::size_t>(best - labels.begin())] = true;
    }
    const auto num_greatest =
        static_cast<std::size_t>(std::count(is_greatest.begin(), is_greatest.end(), true));
    LinePoint point;
    point.is_decided = num_greatest >= kFewestLabels;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (!point.is_decided || is_greatest[i]) point.labels.push_back(labels[i].label);
    const Point center = box.center();
    for (std::size_t axis = 0; axis < 3; ++axis) point.voxels[axis] = block_[axis] + center[axis];
    if (plane_) point.voxels[axis_] = *plane_;
    if (function_.is_outside_box(point.voxels)) return;
    point.world = frame_.voxels_to_world(point.voxels);
    points_.push_back(std::move(point));
  }

  const LabelFunction& function_;
  const ImageFrame& frame_;
  std::vector<LinePoint>& points_;
  std::array<int, 3> block_{};
  std::optional<double> plane_;  // of a side, while it is searched
  std::size_t axis_ = 0;         // across the side
};

// Searches the sides of a flat box that pass through the block.
void search_sides(BlockSearch& search, const std::array<int, 3>& block, const std::array<int, 3>& size) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool is_high : {false, true})
      if (block[axis] == (is_high ? size[axis] - 1 : -1)) search.search_side(block, axis, is_high);
}

}  // namespace

double side_of_floor_voxels() { return std::pow(1 - kLowerShare, kCuts); }

std::vector<LinePoint> lines_of_image(const Image& image, const ImageFrame& frame, int threads) {
  struct Points {
    std::vector<LinePoint> points;
    void add(const Points& more) { points.insert(points.end(), more.points.begin(), more.points.end()); }
  };
  const LabelFunction function(image);
  const auto& size = image.size;
  // Blocks begin one voxel before the grid.
  return sum_over_ranges(static_cast<std::size_t>(size[2]) + 1, threads, Points{},
                         [&](std::size_t begin, std::size_t end, Points& found) {
                           BlockSearch search(function, frame, found.points);
                           for (int k = static_cast<int>(begin) - 1; k < static_cast<int>(end) - 1; ++k)
                             for (int j = -1; j < size[1]; ++j)
                               for (int i = -1; i < size[0]; ++i) {
                                 search.search({i, j, k});
                                 if (image.is_box_flat) search_sides(search, {i, j, k}, size);
                               }
                         })
      .points;
}

}  // namespace podm::verify
