// Sources of label images: files, phantoms and arrays in memory; and the selection of labels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "podm/label_image.h"
#include "podm/option.h"
#include "podm/size_image.h"
#include "podm/value_image.h"

namespace podm {

/// Layers of a segmentation, from the bottom to the top.
using LayerOrder = std::vector<std::size_t>;

/// The labels of an image that are kept, their values and their names. Values are those stored in the file,
/// unless segments share stored values (Segment::label).
struct LabelSelection {
  std::uint32_t background = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keep = {};  ///< closed ranges; empty: all
  std::vector<std::pair<std::uint32_t, std::uint32_t>> drop = {};  ///< closed ranges
  struct Merge {
    std::vector<std::uint32_t> values;  ///< these values become one label with the first value
    std::string name;
  };
  std::vector<Merge> merges = {};
  /// Smaller components of a resulting label go to a neighbour, mm^3. Faces join the voxels of a component.
  /// 0: all components stay.
  double drop_islands_mm3 = 0;
  /// The layers that are read. Empty: all; segments that come later in the file are then above earlier ones.
  LayerOrder layers = {};
  /// Names and colours that replace those in the file. The last entry of a value counts.
  std::vector<Label> table = {};

  static constexpr auto options() {
    using L = LabelSelection;
    using enum OptionGroup;
    constexpr unsigned kUses = kInPodm | kOnRanks | kInPython;
    return std::tuple{
        option(&L::keep, "labels", "RANGES", kLabels, "keep only these label values, e.g. 1,3-7",
               {.unset = "all", .uses = kUses, .keyword = "keep"}),
        option(&L::drop, "drop", "RANGES", kLabels, "turn these label values into background",
               {.unset = "none", .uses = kUses}),
        option(&L::merges, "merge", "VALUES=NAME", kLabels,
               "merge several labels into one, e.g. 2,3=kidney; repeatable",
               {.unset = "none", .uses = kUses}),
        option(&L::layers, "layers", "LAYERS", kLabels,
               "layers of a .seg.nrrd of 3D Slicer that are read, bottom to top, e.g. 1,0",
               {.unset = "all, later segments above earlier ones", .uses = kUses}),
        option(&L::drop_islands_mm3, "drop-islands", "MM3", kLabels,
               "relabel components (voxels joined by faces) smaller than this, mm^3, to the\n"
               "neighbour that shares the largest area",
               {.unset = "none", .uses = kUses, .quantity = "volume in mm^3"}),
        option(&L::background, "background", "VALUE", kLabels, "label value of the background",
               {.uses = kUses, .least = 0})};
  }
};

/// Parses "1,3-7". Throws InputError that names `option` and the fault.
std::vector<std::pair<std::uint32_t, std::uint32_t>> parse_label_ranges(const std::string& text,
                                                                        const std::string& option);
/// Parses "1,0". Throws InputError that names `option` and the fault.
LayerOrder parse_layers(const std::string& text, const std::string& option);
/// Parses "2,3=kidney".
LabelSelection::Merge parse_merge(const std::string& text);

/// Reads names and colours of labels, in a format that it recognises by content: ITK-SNAP's label
/// descriptions, colour tables of FreeSurfer and 3D Slicer (.ctbl), or lines "value name ..." as in
/// aal.nii.txt. Throws InputError that names the file, the line and the fault.
std::vector<Label> read_label_table(const std::string& path);

/// Reads NIfTI, NRRD, MetaImage, INR (each .gz where usual), or "phantom:NAME[@SIZE]". Throws InputError that
/// names the file and the fault. Labels are sorted by value. `threads`: 0 for all cores. `most_bytes`: memory
/// limit for a file's voxels and their labels together during reading.
///
/// The layers of a segmentation of 3D Slicer (.seg.nrrd) are merged: a voxel has the label of the topmost
/// segment that covers it. Segments that the selection does not keep are below all others.
LabelImage read_image(const std::string& path, const LabelSelection& selection = {}, int threads = 0,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Reads a size image of the same formats and any voxel type. Values that are not above 0, or are infinite,
/// give no bound. Throws InputError that names the file and the fault: it is not 3-D, a voxel is not a
/// number, or no voxel has a bound.
SizeImage read_size_image(const std::string& path,
                          std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Reads an image of values, of the same formats and any voxel type. Throws InputError that names the file
/// and the fault: it is not 3-D, or a voxel is not a finite number.
ValueImage read_value_image(const std::string& path,
                            std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

enum class VoxelType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat, kDouble };

/// Voxels in the caller's memory, in this machine's byte order. `strides_bytes` is the distance between
/// voxels along each axis. It may be negative or 0.
struct VoxelArray {
  const void* first = nullptr;  ///< voxel (0,0,0)
  VoxelType type = VoxelType::kUint8;
  std::vector<int> size;  ///< voxels per axis: three numbers, or more if the additional ones are 1
  std::array<std::ptrdiff_t, 3> strides_bytes{};
};

/// Makes a label image from an array, which is read and not kept. `voxel_to_ras`: row-major 3x4, mm. Throws
/// InputError that names the array (`name`) and the fault. The other parameters are those of read_image().
LabelImage image_of_array(const VoxelArray& array, std::array<double, 12> voxel_to_ras,
                          const std::string& name, const LabelSelection& selection = {}, int threads = 0,
                          std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Makes an analytic phantom (one of phantom_names()) with `size` voxels along the longest axis.
LabelImage make_phantom(const std::string& name, int size, int threads = 0);
std::vector<std::string> phantom_names();

/// Writes a NIfTI-1 label image (.nii or .nii.gz). On failure no file appears.
void write_nifti(const LabelImage& image, const std::string& path);

}  // namespace podm
