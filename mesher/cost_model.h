// What a mesh will cost, from the image alone: cells fill the volume as r_t^-3 and cover the interfaces as
// delta^-2. `threads`: 0 for all cores.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/box.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"
#include "size_census.h"

namespace podm {

/// Voxels by label, the background too.
std::vector<std::uint64_t> count_voxels(const LabelImage& image, int threads);

/// Bounds of the foreground in the working frame, mm: centres of the labelled voxels and one voxel more on
/// every side.
Box foreground_bounds(const LabelImage& image, int threads = 1);

/// Cells that the labels' volumes and interfaces ask for:
///   kVolumeCells V / r_t^3 in the core of each label, kSurfaceCells A / delta^2 along the interfaces,
/// where A counts an interface for each label at it, since cells stand on both sides of one between two
/// labels, and in voxel faces. Cells grow from delta to r_t in a layer; the core is what a ball of the same
/// share of volume and surface has left without it. What is thinner than the surface is sampled is missed:
/// A is that of label changes between voxels so far apart, each counted once.
/// Constants were fitted to 166 meshes of eleven images, segmentations and phantoms. With delta = r_t / 2,
/// meshes of 0.06 to 5.5 million cells are predicted within 8 %, two of three within 3 %; smaller ones within
/// 18 %, and with other deltas within 34 %.
class CostModel {
 public:
  /// The image must outlive the model, which looks at its interfaces as they are asked for. `census`: of
  /// sizes by place; none, and those of labels are all.
  CostModel(const LabelImage& image, int threads, std::optional<SizeCensus> census = std::nullopt);

  /// Null: there are no sizes by place.
  const SizeCensus* census() const { return census_ ? &*census_ : nullptr; }

  /// The cells that these radii and this delta, which is not 0, make; places have those of
  /// the census, with the factor that these have for the image.
  double cells(const SizeOptions& sizes) const;
  /// The same by label: each label's own volume and interfaces; together they are cells(). What is thinner
  /// than delta is put down to the wrong label more often: of labels of 1000 cells and more, in 24 meshes of
  /// eight segmentations, nine in ten were predicted within 15 %, the root mean square was 10 %.
  std::vector<double> cells_by_label(const SizeOptions& sizes) const;
  /// Cells of the background that the mesh is made with, those outside of the object among them:
  /// kOutsideCells times its area in cells of delta, within 25 %.
  double background_cells(const SizeOptions& sizes) const;
  /// Of a part of a label, and of the interface at it, where the layer is thin. `radius_mm`: 0 if unbounded.
  static double cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm);

 private:
  static constexpr double kVolumeCells = 4.82, kSurfaceCells = 1.57, kOutsideCells = 2.55;
  static constexpr double kGradedOverRadius = 0.555;  // thickness of the layer
  static constexpr double kSeenOverDelta = 1.6;       // distance of the voxels compared
  static constexpr double kSpacingOverRadius = 0.7;   // of surface samples where cells are small
  // Areas are found at these distances, in voxels, and interpolated between them.
  static constexpr std::array<int, 13> kLags{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96};

  // Calls add(axis, lag, share): by which areas of lags are interpolated.
  template <class Add>
  void interpolate(double distance_mm, const Add& add) const;
  double area_mm2(double distance_mm) const;
  std::vector<double> areas_by_label_mm2(double distance_mm) const;  // the background's, too
  std::vector<double> areas_along_mm2(std::size_t axis, std::size_t lag) const;
  double area_along_mm2(std::size_t axis, std::size_t lag) const;
  double mean_radius_mm(LabelIndex label, const SizeOptions& sizes) const;
  double surface_growth(const SizeOptions& sizes) const;

  const LabelImage& image_;
  int threads_;
  std::vector<double> volume_of_label_mm3_;
  std::optional<SizeCensus> census_;
  double volume_mm3_ = 0;
  mutable std::array<std::array<std::optional<double>, kLags.size()>, 3> area_along_mm2_;  // by axis and lag
};

/// estimate() where the grid of the options' sizes is made already; null: there is none.
Estimate estimate(const LabelImage& image, const MeshingOptions& options, const SizeGrid* grid);

}  // namespace podm
