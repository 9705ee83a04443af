// How far a voxel lies from where its label, blurred, ties with another: the distances of
// smooth_interfaces.h, for one width, in tiles of 16^3 voxels.
#pragma once

#include <array>
#include <vector>

#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

inline constexpr int kTileSide = 16;
inline constexpr std::size_t kTileVoxels = 16 * 16 * 16;

/// A place in a tile, x fastest.
constexpr std::size_t place_in_tile(int i, int j, int k) {
  return static_cast<std::size_t>(i + kTileSide * (j + kTileSide * k));
}

class InterfaceBlur {
 public:
  /// Keeps a reference to `image`.
  InterfaceBlur(const LabelImage& image, double width_mm);

  double width_mm() const { return width_mm_; }

  /// What one thread works in; goes from tile to tile.
  class Desk;
  /// Distances in mm by place, positive where the label keeps its voxel; those beyond the image mean nothing.
  /// `first` is the tile's lowest voxel.
  const std::array<double, kTileVoxels>& distances_mm(const Voxel& first, Desk& desk) const;

 private:
  // Of a Gaussian along one axis: taps for -reach to reach, of sum 1.
  struct Taps {
    int reach = 0;
    std::vector<double> weights;
  };
  static Taps taps(double width_voxels);
  void read_window(const Voxel& first, Desk& desk) const;
  void blur(const std::array<Taps, 3>& gaussian, double factor, Desk& desk) const;

  const LabelImage& image_;
  double width_mm_;
  double mm_per_lead_;                    // of distance, by the lead of a weight
  std::array<Taps, 3> narrow_, wide_;     // by axis, of the width and of twice the width
  std::array<int, 3> halo_{}, window_{};  // voxels around a tile, with it
};

class InterfaceBlur::Desk {
 private:
  friend class InterfaceBlur;
  std::vector<LabelIndex> window, labels;                     // labels: each once
  std::vector<float> indicator;                               // of a label, in the window
  std::vector<double> by_z, by_yz;                            // blurred along these axes
  std::array<double, kTileVoxels> weight, of_own, of_others;  // of_others: the greatest
  std::array<double, kTileVoxels> distances;
};

}  // namespace podm
