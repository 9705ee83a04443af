// Sampling distances that keep thin layers of labels, gaps of the background among them.
//
// The thin voxels are those of thin_parts.h, with the background as one more label. A part of them is a layer
// if it is all of a component, joins pieces of one, or reaches farther from its thick pieces than delta. All
// other parts are the edges and the roughness of thick pieces. The thickness at a voxel is a length that
// three measures bound:
//   twice the depth of the deepest ball that covers the voxel, and a voxel's shortest side more, because a
//   ball around a voxel of a plate of two voxels has the same depth as in a plate of one;
//   the shortest run of the label along an axis through the voxel, which is exact in plates across an axis.
// A layer of this thickness needs kDeltaOverThickness of it as delta. Nothing proves that this keeps the
// layer. The comparison of topologies (topology/) finds where it does not.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "image/voxel.h"
#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "sizing/delta_field.h"

namespace podm {

inline constexpr double kDeltaOverThickness = 0.7;
/// The most memory that thin layers and the comparison of topologies take, in bytes.
inline constexpr std::uint64_t kBytesPerVoxelOfLayers = 24;

/// Deltas at voxels, which can be lowered.
class DeltasAtVoxels {
 public:
  /// All are `most_mm` at first. The image must outlive the object.
  DeltasAtVoxels(const LabelImage& image, double least_mm, double most_mm);

  double least_mm() const { return least_mm_; }
  double most_mm() const { return most_mm_; }
  double at(std::size_t voxel) const { return deltas_mm_[voxel]; }
  /// Lowers the delta at a voxel to this one, or to the least. Returns false if it was as low before.
  bool lower(std::size_t voxel, double delta_mm);
  /// The largest field that is Lipschitz and nowhere above these deltas at the voxels. Their own values
  /// become the field's.
  std::shared_ptr<const DeltaField> graded();

 private:
  const LabelImage* image_;
  double least_mm_, most_mm_;
  std::vector<float> deltas_mm_;
};

struct ThinnestPlace {
  LabelIndex label = kBackground;
  Voxel voxel;
  double thickness_mm = 0;
};

struct ThinLayers {
  DeltasAtVoxels deltas;
  std::uint64_t num_voxels = 0;           ///< of all layers
  std::optional<ThinnestPlace> thinnest;  ///< none: no layer is thin
};

/// A part of the interfaces between voxels, by area, and the delta there.
struct DeltaShare {
  double delta_mm, share;
};
/// The parts of all interfaces, for deltas in steps of a quarter of a power of two.
std::vector<DeltaShare> shares_of_deltas(const LabelImage& image, const DeltasAtVoxels& deltas);

/// The least delta of a run: the one that the options give, otherwise half of a voxel's shortest side, and at
/// most `delta_mm`. Throws InputError if the options give one above `delta_mm`.
double least_delta_mm(const LabelImage& image, const SizeOptions& sizes, double delta_mm);

/// Finds the layers that delta_mm would lose. Throws InputError if the options give a least delta that the
/// thinnest of them does not allow, with its place. `threads`: 0 for all cores.
ThinLayers find_thin_layers(const LabelImage& image, const SizeOptions& sizes, double delta_mm, int threads);

}  // namespace podm
