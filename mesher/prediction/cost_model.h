// What a mesh will cost, from the image alone: its cells grow from delta at the interfaces to r_t inside.
// `threads`: 0 for all cores.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "image/foreground.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"
#include "sizing/size_census.h"

namespace podm {

/// Cells that the labels' volumes and interfaces ask for. At interfaces their circumradius is kFirstOverDelta
/// delta, inside it grows by kGrowth of the way until it is r_t; kVolumeCells fill the cube of the radius,
/// and kSurfaceCells more stand on a square of delta of an interface. How much is how deep is what a ball of
/// the same volume and surface has. The surface A counts an interface for each label at it, since cells stand
/// on both sides of one between two labels, and in voxel faces. What is thinner than surfaces are sampled is
/// missed: A is that of label changes between voxels so far apart, each counted once.
/// Constants were fitted to 105 meshes of seven segmentations of 20 thousand to 3 million cells, with deltas
/// of 0.1 to 1 of r_t: 104 were predicted within 15 %, the root mean square was 5 %.
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
  /// than delta is put down to the wrong label more often: of labels of 1000 cells and more, in 32 meshes of
  /// eight segmentations, nineteen in twenty were predicted within 15 %, the root mean square was 7 %.
  std::vector<double> cells_by_label(const SizeOptions& sizes) const;
  /// Cells of the background that the mesh is made with, those outside of the object among them:
  /// kOutsideCells times its area in cells of delta, or of sizes by place, within 25 %.
  double background_cells(const SizeOptions& sizes) const;
  /// Squares of delta that cover the interfaces, those between two labels from both sides.
  double squares(const SizeOptions& sizes) const;
  /// Of a part of a label, and of the interface at it. `radius_mm`: infinity if unbounded.
  static double cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm);

 private:
  static constexpr double kVolumeCells = 4.69, kSurfaceCells = 0.54, kOutsideCells = 2.55;
  static constexpr double kFirstOverDelta = 1.34, kGrowth = 0.52;
  static constexpr double kSpacingOverRadius = 0.65;  // of surface samples where cells are small
  // Distances of the voxels compared, for the object's cells and those outside.
  static constexpr double kSeenOverDelta = 0.8, kSeenOutsideOverDelta = 1.6;
  // Areas are found at these distances, in voxels, and interpolated between them.
  static constexpr std::array<int, 13> kLags{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96};

  // Calls add(axis, lag, share): by which areas of lags are interpolated.
  template <class Add>
  void interpolate(double distance_mm, const Add& add) const;
  static double volume_cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm);
  double area_mm2(double distance_mm) const;
  std::vector<double> areas_by_label_mm2(double distance_mm) const;  // the background's, too
  std::vector<double> areas_along_mm2(std::size_t axis, std::size_t lag) const;
  double area_along_mm2(std::size_t axis, std::size_t lag) const;
  double mean_radius_mm(LabelIndex label, const SizeOptions& sizes) const;
  double surface_growth(const SizeOptions& sizes, double SizeCensus::Places::*share) const;

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
