#include "smoothing/smooth_interfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "podm/errors.h"
#include "runtime/parallel_for.h"
#include "smoothing/interface_blur.h"
#include "smoothing/interface_shift.h"

namespace podm {

namespace {

// All in sides of a voxel, unless noted.
constexpr double kLost = 0.25;     // distance beyond its interface from which a voxel counts as lost
constexpr double kLeast = 0.05;    // least distance that is set
constexpr double kStairs = 0.5;    // distance that makes stairs, and the width below which stairs remain
constexpr double kLostReach = 2;   // widths
constexpr double kShiftReach = 2;  // widths
constexpr int kTimesKept = 2;
constexpr double kMostDistance = 1.1;  // widths: weights lead by 1.2 at most, distances are 0.84 of that

using Place = std::uint16_t;  // in a tile

struct Tile {
  Voxel first, end;                 // of its voxels
  bool has_sides = false;           // true if the weight of any voxel is set
  std::vector<Place> left;          // voxels beside another label that still need a width
  std::vector<Place> lost;          // those voxels of `left` that the present width loses
  std::vector<std::uint16_t> kept;  // volume-preserving weights of the voxels with a weight, x fastest

  static Place place(const Voxel& from_first) {
    return static_cast<Place>(place_in_tile(from_first.i, from_first.j, from_first.k));
  }
  Voxel voxel(Place place) const {
    return {first.i + place % kTileSide, first.j + place / kTileSide % kTileSide,
            first.k + place / kTileSide / kTileSide};
  }
  template <class Visit>
  void for_each_voxel(const Visit& visit) const {
    for (int k = 0; k < end.k - first.k; ++k)
      for (int j = 0; j < end.j - first.j; ++j)
        for (int i = 0; i < end.i - first.i; ++i) visit(place({i, j, k}));
  }
};

// The side of a cube with the volume of a voxel.
double side_of_voxel_mm(const LabelImage& image) {
  return std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2]);
}

class InterfaceSmoother {
 public:
  InterfaceSmoother(const LabelImage& image, double width_mm, std::size_t threads);

  SmoothInterfaces operator()() {
    for_each_tile([&](Tile& tile, std::size_t) { find_sides(tile); });
    for (double width_mm = width_mm_; is_left(); width_mm /= 2) {
      if (keeps_all_stairs(image_, width_mm)) {
        for_each_tile([&](Tile& tile, std::size_t) { leave_stairs(tile); });
        break;
      }
      blur_by(width_mm);
    }
    for (int time = 0; time < kTimesKept; ++time) keep_volumes();
    return {weights_, labels_lost()};
  }

 private:
  template <class Work>
  void for_each_tile(const Work& work) {
    parallel_for(tiles_.size(), threads_,
                 [&](std::size_t t, std::size_t thread) { work(tiles_[t], thread); });
  }
  bool is_left() const {
    return std::any_of(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return !tile.left.empty(); });
  }
  std::uint16_t parts(double distance_mm) const {
    const double parts = std::round(std::max(distance_mm, kLeast * voxel_mm_) * parts_per_mm_);
    return static_cast<std::uint16_t>(std::min(parts, double{VoxelWeights::kMost}));
  }
  std::size_t index(const Voxel& v) const { return image_.index(v.i, v.j, v.k); }
  bool is_uniform(const Tile& tile) const;
  bool is_beside_another(const Voxel& v) const;
  void find_sides(Tile& tile) const;
  void blur_by(double width_mm);
  void blur_tile(Tile& tile, const InterfaceBlur& blur, InterfaceBlur::Scratch& scratch,
                 std::vector<std::int64_t>& lead_of_kept);
  void leave_near_lost(Tile& tile, const std::array<int, 3>& reach);
  void leave_stairs(Tile& tile);
  std::array<int, 3> voxels_within(double distance_mm) const;
  template <class Visit>
  void for_each_weighted(const Tile& tile, const Visit& visit) const;
  void keep_volumes();
  std::vector<LabelIndex> labels_lost() const;

  const LabelImage& image_;
  const LabelGrid<NoReads> grid_;
  const std::size_t threads_;
  const double width_mm_, voxel_mm_, parts_per_mm_;
  std::array<int, 3> num_tiles_{};
  std::vector<Tile> tiles_;
  std::shared_ptr<VoxelWeights> weights_;
  // The number of voxels, by thread and label, beside another label that the whole width keeps, minus the
  // number that it loses.
  std::vector<std::vector<std::int64_t>> lead_of_kept_;
};

InterfaceSmoother::InterfaceSmoother(const LabelImage& image, double width_mm, std::size_t threads)
    : image_(image),
      grid_(image, {}),
      threads_(threads),
      width_mm_(width_mm),
      voxel_mm_(side_of_voxel_mm(image)),
      parts_per_mm_(VoxelWeights::kMost / std::max(kMostDistance * width_mm, kStairs * voxel_mm_)),
      weights_(std::make_shared<VoxelWeights>(image.size)),
      lead_of_kept_(threads, std::vector<std::int64_t>(image.labels.size())) {
  for (std::size_t a = 0; a < 3; ++a) num_tiles_[a] = (image.size[a] + kTileSide - 1) / kTileSide;
  for (int k = 0; k < num_tiles_[2]; ++k)
    for (int j = 0; j < num_tiles_[1]; ++j)
      for (int i = 0; i < num_tiles_[0]; ++i) {
        Tile& tile = tiles_.emplace_back();
        tile.first = {i * kTileSide, j * kTileSide, k * kTileSide};
        tile.end = {std::min(tile.first.i + kTileSide, image_.size[0]),
                    std::min(tile.first.j + kTileSide, image_.size[1]),
                    std::min(tile.first.k + kTileSide, image_.size[2])};
      }
}

bool InterfaceSmoother::is_beside_another(const Voxel& v) const {
  const LabelIndex own = grid_.label(v);
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        if (grid_.label({v.i + i, v.j + j, v.k + k}) != own) return true;
  return false;
}

// True if the tile and the voxels around it have one label. Voxels outside the grid are background.
bool InterfaceSmoother::is_uniform(const Tile& tile) const {
  const Voxel low{std::max(tile.first.i - 1, 0), std::max(tile.first.j - 1, 0),
                  std::max(tile.first.k - 1, 0)};
  const Voxel end{std::min(tile.end.i + 1, image_.size[0]), std::min(tile.end.j + 1, image_.size[1]),
                  std::min(tile.end.k + 1, image_.size[2])};
  const bool is_at_border = low.i == tile.first.i || low.j == tile.first.j || low.k == tile.first.k ||
                            end.i == tile.end.i || end.j == tile.end.j || end.k == tile.end.k;
  const LabelIndex first = is_at_border ? kBackground : grid_.label(low);
  for (int k = low.k; k < end.k; ++k) {
    for (int j = low.j; j < end.j; ++j) {
      const LabelIndex* row = &image_.voxels[image_.index(0, j, k)];
      unsigned differing = 0;  // the loop has no branch, so that it can be vectorised
      for (int i = low.i; i < end.i; ++i) differing |= static_cast<unsigned>(row[i] ^ first);
      if (differing != 0) return false;
    }
  }
  return true;
}

void InterfaceSmoother::find_sides(Tile& tile) const {
  if (is_uniform(tile)) return;
  tile.for_each_voxel([&](Place place) {
    if (is_beside_another(tile.voxel(place))) tile.left.push_back(place);
  });
  tile.has_sides = !tile.left.empty();
}

// Computes the distances of all voxels that are left. Voxels near a lost voxel stay left.
void InterfaceSmoother::blur_by(double width_mm) {
  const InterfaceBlur blur(image_, width_mm);
  std::vector<InterfaceBlur::Scratch> scratch(threads_);
  for_each_tile(
      [&](Tile& tile, std::size_t thread) { blur_tile(tile, blur, scratch[thread], lead_of_kept_[thread]); });
  const std::array<int, 3> reach = voxels_within(kLostReach * width_mm);
  for_each_tile([&](Tile& tile, std::size_t) { leave_near_lost(tile, reach); });
}

void InterfaceSmoother::blur_tile(Tile& tile, const InterfaceBlur& blur, InterfaceBlur::Scratch& scratch,
                                  std::vector<std::int64_t>& lead_of_kept) {
  tile.lost.clear();
  if (tile.left.empty()) return;
  const auto& distances_mm = blur.distances_mm(tile.first, scratch);
  for (const Place place : tile.left) {
    const double d = distances_mm[place];
    const std::size_t voxel = index(tile.voxel(place));
    const bool is_lost = d < -kLost * voxel_mm_;
    if (is_lost) tile.lost.push_back(place);
    if (blur.width_mm() == width_mm_) lead_of_kept[image_.voxels[voxel]] += is_lost ? -1 : 1;
    weights_->at(voxel) = parts(d);
  }
}

void InterfaceSmoother::leave_near_lost(Tile& tile, const std::array<int, 3>& reach) {
  if (tile.left.empty()) return;
  std::array<bool, kTileVoxels> is_near{};
  const auto mark = [&](const Voxel& lost) {
    const auto low = [&](int at, int first, std::size_t a) { return std::max(at - reach[a] - first, 0); };
    const auto end = [&](int at, int first, std::size_t a) {
      return std::min(at + reach[a] + 1 - first, kTileSide);
    };
    for (int k = low(lost.k, tile.first.k, 2); k < end(lost.k, tile.first.k, 2); ++k)
      for (int j = low(lost.j, tile.first.j, 1); j < end(lost.j, tile.first.j, 1); ++j)
        for (int i = low(lost.i, tile.first.i, 0); i < end(lost.i, tile.first.i, 0); ++i)
          is_near[place_in_tile(i, j, k)] = true;
  };
  const auto tile_at = [&](int voxel, std::size_t a) {
    return std::clamp(voxel, 0, image_.size[a] - 1) / kTileSide;
  };
  for (int k = tile_at(tile.first.k - reach[2], 2); k <= tile_at(tile.end.k - 1 + reach[2], 2); ++k)
    for (int j = tile_at(tile.first.j - reach[1], 1); j <= tile_at(tile.end.j - 1 + reach[1], 1); ++j)
      for (int i = tile_at(tile.first.i - reach[0], 0); i <= tile_at(tile.end.i - 1 + reach[0], 0); ++i) {
        const Tile& other = tiles_[static_cast<std::size_t>((k * num_tiles_[1] + j) * num_tiles_[0] + i)];
        for (const Place lost : other.lost) mark(other.voxel(lost));
      }
  std::erase_if(tile.left, [&](Place place) { return !is_near[place]; });
}

void InterfaceSmoother::leave_stairs(Tile& tile) {
  for (const Place place : tile.left) weights_->at(index(tile.voxel(place))) = parts(kStairs * voxel_mm_);
}

std::array<int, 3> InterfaceSmoother::voxels_within(double distance_mm) const {
  std::array<int, 3> voxels{};
  for (std::size_t a = 0; a < 3; ++a) voxels[a] = voxels_to_cover(distance_mm / image_.spacing[a]);
  return voxels;
}

template <class Visit>
void InterfaceSmoother::for_each_weighted(const Tile& tile, const Visit& visit) const {
  if (!tile.has_sides) return;
  tile.for_each_voxel([&](Place place) {
    const std::size_t voxel = index(tile.voxel(place));
    if (weights_->at(voxel) != VoxelWeights::kUnset) visit(place, voxel);
  });
}

// Finds all new weights before any weight is changed.
void InterfaceSmoother::keep_volumes() {
  const InterfaceShift shift(image_, *weights_, voxels_within(kShiftReach * width_mm_));
  std::vector<InterfaceShift::Scratch> scratch(threads_);
  const double least = parts(0);
  for_each_tile([&](Tile& tile, std::size_t thread) {
    const std::array<double, kTileVoxels>* shifts = nullptr;
    for_each_weighted(tile, [&](Place place, std::size_t voxel) {
      if (shifts == nullptr) shifts = &shift.shifts(tile.first, scratch[thread]);
      const double kept = std::round(weights_->at(voxel) - (*shifts)[place]);
      tile.kept.push_back(static_cast<std::uint16_t>(std::clamp(kept, least, double{VoxelWeights::kMost})));
    });
  });
  for_each_tile([&](Tile& tile, std::size_t) {
    auto kept = tile.kept.begin();
    for_each_weighted(tile, [&](Place, std::size_t voxel) { weights_->at(voxel) = *kept++; });
    tile.kept.clear();
  });
}

std::vector<LabelIndex> InterfaceSmoother::labels_lost() const {
  std::vector<LabelIndex> lost;
  for (std::size_t label = 1; label < image_.labels.size(); ++label) {
    std::int64_t lead = 0;
    for (const auto& of_thread : lead_of_kept_) lead += of_thread[label];
    if (lead < 0) lost.push_back(static_cast<LabelIndex>(label));
  }
  return lost;
}

}  // namespace

bool keeps_all_stairs(const LabelImage& image, double width_mm) {
  return width_mm < (1 - kLengthRounding) * kStairs * side_of_voxel_mm(image);
}

void check_width(const LabelImage& image, double width_mm) {
  std::array<double, 3> sides_mm;
  for (std::size_t a = 0; a < 3; ++a) sides_mm[a] = image.size[a] * image.spacing[a];
  const double side_mm = *std::min_element(sides_mm.begin(), sides_mm.end());
  const double most_mm = kMostWidth * *std::min_element(image.spacing.begin(), image.spacing.end());
  if (!(width_mm > 0 && width_mm <= most_mm && width_mm < side_mm))
    throw InputError(
        fmt::format("a blur of {:g} mm: the width must be above 0, at most {} of the shortest side of a "
                    "voxel, which is {:g} mm here, and below the shortest side of the image, {:g} mm",
                    width_mm, kMostWidth, most_mm, side_mm));
}

SmoothInterfaces smooth_interfaces(const LabelImage& image, double width_mm, int threads) {
  check_width(image, width_mm);
  return InterfaceSmoother(image, width_mm, num_threads(threads))();
}

std::shared_ptr<const VoxelWeights> weights_of(const LabelImage& image, double width_mm, int threads) {
  return width_mm > 0 ? smooth_interfaces(image, width_mm, threads).weights : nullptr;
}

}  // namespace podm
