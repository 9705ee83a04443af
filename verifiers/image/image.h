// The segmented image that a mesh is compared with, read by the verifier's own code.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mesh.h"

namespace podm::verify {

/// Smoothed interfaces of the image (smoothing.h).
struct Smoothing {
  double width_mm = 0;
  std::vector<std::uint16_t> voxel_weights;  ///< one per voxel, in 65535ths
};
inline constexpr std::uint16_t kFullVoxelWeight = 65535;

/// Voxels are stored x fastest. Outside the grid every voxel is background (0), unless the box is flat
/// (label_function.h).
struct Image {
  std::string path;
  std::array<int, 3> size{};
  std::array<double, 3> spacing{};         ///< mm: column norms of voxel_to_ras
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, voxel indices to world mm
  std::vector<std::uint32_t> voxels;       ///< label values
  std::vector<std::string> warnings = {};  ///< oddities of the file
  std::optional<Smoothing> smoothing = {};
  bool is_box_flat = false;                     ///< the outer faces of the outermost voxels end the labels
  std::set<std::uint32_t> covered_labels = {};  ///< of segments that others cover, perhaps entirely
};

struct LabelSelection;

/// Reads NIfTI, NRRD, MetaImage, INRIMAGE, and ".gz" of NIfTI and INR. The selection, which is not applied
/// here, decides how the layers of a segmentation are merged (segmentation.h). Throws InputError.
Image read_image(const std::string& path, const LabelSelection& selection);
Image read_image(const std::string& path);  ///< with all labels and layers

}  // namespace podm::verify
