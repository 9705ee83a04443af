// Predicts the cost of a mesh from the image alone: cells grow from delta at the interfaces to r_t inside.
// `threads`: 0 for all cores.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "image/foreground.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"
#include "sizing/size_census.h"
#include "sizing/thin_layers.h"

namespace podm {

/// Predicts the number of cells from the volumes and interfaces of the labels. At interfaces the circumradius
/// is kFirstOverDelta delta. Inside it grows by kGrowth per distance from the interface, up to r_t. A cube
/// with the radius as side contains kVolumeCells cells. A square of an interface with side delta adds
/// kSurfaceCells cells. The volume at each depth is that of a ball of the same volume and surface. The
/// surface A is measured in voxel faces. It counts an interface once per label at it, as there are cells on
/// both sides of an interface between two labels. A mesh misses parts that are thinner than the distance of
/// surface samples. A is therefore the area of the label changes between voxels at that distance, each
/// counted once.
///
/// The constants were fitted to 105 meshes of seven segmentations, of 20 thousand to 3 million cells, with
/// deltas of 0.1 to 1 of r_t. 104 of them were predicted within 15 %; the root mean square error was 5 %.
class CostModel {
 public:
  /// The image must outlive the model, which examines its interfaces on demand. `census` describes local
  /// sizes; without it sizes depend on labels only.
  CostModel(const LabelImage& image, int threads, std::optional<SizeCensus> census = std::nullopt);

  /// Null if there are no local sizes.
  const SizeCensus* census() const { return census_ ? &*census_ : nullptr; }

  /// The number of cells with these radii and this delta, which must not be 0. Local sizes are those of the
  /// census, with the size image's factor in `sizes`.
  double cells(const SizeOptions& sizes) const;
  /// The number of cells by label, from each label's own volume and interfaces. The sum is cells(). Parts
  /// thinner than delta are more often assigned to the wrong label. Among labels of at least 1000 cells, in
  /// 32 meshes of eight segmentations, 19 of 20 were predicted within 15 %; the root mean square error was 7
  /// %.
  std::vector<double> cells_by_label(const SizeOptions& sizes) const;
  /// The number of background cells that the mesh is made with, including those outside the object:
  /// kOutsideCells per square of its area with side delta, or with the spacing of local sizes. It is accurate
  /// within 25 %.
  double background_cells(const SizeOptions& sizes) const;
  /// The number of squares with side delta that cover the interfaces. An interface between two labels counts
  /// from both sides.
  double squares(const SizeOptions& sizes) const;
  /// The number of cells with these thin layers kept, over that without: the mean, over the interfaces, of
  /// the number with the delta of a place everywhere. `delta_mm` must not be 0.
  double growth_with(const ThinLayers& layers, const SizeOptions& sizes) const;
  /// The number of cells of a part of a label and of the interface at it. `radius_mm` is infinity if
  /// unbounded.
  static double cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm);

 private:
  static constexpr double kVolumeCells = 4.69, kSurfaceCells = 0.54, kOutsideCells = 2.55;
  static constexpr double kFirstOverDelta = 1.34, kGrowth = 0.52;
  static constexpr double kSpacingOverRadius = 0.65;  // spacing of surface samples where cells are small
  // Distances of the compared voxels, for the object's cells and for those outside.
  static constexpr double kSeenOverDelta = 0.8, kSeenOutsideOverDelta = 1.6;
  // Areas are computed at these distances, in voxels, and interpolated between them.
  static constexpr std::array<int, 13> kLags{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96};

  // Calls add(axis, lag, share) with the shares by which the areas at the lags are interpolated.
  template <class Add>
  void interpolate(double distance_mm, const Add& add) const;
  static double volume_cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm);
  double area_mm2(double distance_mm) const;
  std::vector<double> areas_by_label_mm2(double distance_mm) const;  // including the background
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

/// The layers that a run keeps, with graded deltas; none: it keeps none.
std::optional<ThinLayers> kept_layers(const LabelImage& image, const SizeOptions& sizes, int threads);

/// As estimate() with the options alone, if the grid of the options' sizes already exists; null if there is
/// no grid. The image may stay in its file. Its memory is then that of a rank if each of `num_ranks` ranks
/// reads what it needs.
Estimate estimate(const LabelImage& image, const MeshingOptions& options, const SizeGrid* grid,
                  int num_ranks = 1);

}  // namespace podm
