// Computes the distance of each voxel from where its blurred label ties with another. These are the distances
// of smooth_interfaces.h, for one width, in tiles of 16^3 voxels.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

inline constexpr int kTileSide = 16;
inline constexpr std::size_t kTileVoxels = 16 * 16 * 16;

/// A place in a tile, x fastest.
constexpr std::size_t place_in_tile(int i, int j, int k) {
  return unsigned_of(i + kTileSide * (j + kTileSide * k));
}

class InterfaceBlur {
 public:
  /// Keeps a reference to `image`.
  InterfaceBlur(const LabelImage& image, double width_mm);

  double width_mm() const { return width_mm_; }

  /// Scratch memory of one thread, reused from tile to tile.
  class Scratch;
  /// Distances in mm by place in the tile, positive where the label keeps its voxel. Distances of voxels
  /// beyond the image are undefined. `first` is the tile's lowest voxel.
  const std::array<double, kTileVoxels>& distances_mm(const Voxel& first, Scratch& scratch) const;

 private:
  // A Gaussian along one axis: taps for -reach to reach, with sum 1.
  struct Taps {
    explicit Taps(double width_voxels);
    std::size_t count() const { return weights.size(); }
    // The sum of the taps from -reach up to, but not including, position - reach.
    double sum_before(int position) const;

    int reach;
    std::vector<double> weights, sums;
  };
  using Gaussian = std::array<Taps, 3>;  // by axis
  static Gaussian gaussian(const LabelImage& image, double width_mm);
  void read_window(const Voxel& first, Scratch& scratch) const;
  void blur_rows(LabelIndex label, const Gaussian& gaussian, Scratch& scratch) const;
  void blur(LabelIndex label, const Gaussian& gaussian, double factor, Scratch& scratch) const;
  void weigh(LabelIndex label, Scratch& scratch) const;
  void compare(LabelIndex label, Scratch& scratch) const;

  const LabelImage& image_;
  double width_mm_;
  double mm_per_lead_;                    // mm of distance per unit of lead in weight
  Gaussian narrow_, wide_;                // of the width and of twice the width
  std::array<int, 3> halo_{}, window_{};  // voxels around a tile; size including them
};

class InterfaceBlur::Scratch {
 private:
  friend class InterfaceBlur;
  struct Run {  // voxels of one label in a row of the window
    LabelIndex label;
    int begin, end;
  };
  struct Presence {
    LabelIndex label;
    std::size_t voxels;  // in the window
  };
  using Row = std::array<double, kTileSide>;  // along x, in the tile

  std::vector<Run> runs;
  std::vector<std::size_t> first_run;  // by row of the window, and one past the last
  std::vector<Presence> labels;        // from the rarest to the most frequent
  std::vector<Row> by_x, by_xz;        // of one label, blurred along these axes
  std::vector<bool> has_label;         // by row of by_x
  std::array<double, kTileVoxels> weight, sum_of_weights, of_own, of_others;  // of_others: the greatest
  std::array<double, kTileVoxels> distances;
};

}  // namespace podm
