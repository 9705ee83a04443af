// Turns a path or an array into a label image: picks a reader, turns voxels into labels and selects labels.
#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <map>
#include <utility>

#include "image/foreground.h"
#include "image/index_voxels.h"
#include "image/label_selection.h"
#include "image/merge_layers.h"
#include "image/read_formats.h"
#include "podm/image_io.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr int kDefaultPhantomSize = 256;

bool has_ending(const std::string& path, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return path.ends_with(ending); });
}

// Indexes labels by value, as the background is not known yet.
LabelImage index_array(const VoxelArray& array, std::array<double, 12> voxel_to_ras, const std::string& path,
                       std::size_t threads) {
  LabelImage image;
  image.size = {array.size[0], array.size[1], array.size[2]};
  image.spacing = checked_spacing(path, voxel_to_ras);
  check_distance(path, array.size, voxel_to_ras);
  image.voxel_to_ras = voxel_to_ras;
  index_voxels(array, path, threads, image);
  return image;
}

// Labels with the name and the colour of their segment.
void name_by_segments(LabelImage& image) {
  std::map<std::uint32_t, const Label*> labels;
  for (const Segment& segment : image.segments) labels[segment.label.value] = &segment.label;
  for (Label& label : image.labels)
    if (const auto found = labels.find(label.value); found != labels.end()) label = *found->second;
}

// For a file of one layer, where no segment covers another.
void count_segments(LabelImage& image, std::size_t threads) {
  if (image.segments.empty()) return;
  const std::vector<std::uint64_t> counts = count_voxels(image, static_cast<int>(threads));
  std::map<std::uint32_t, std::uint64_t> voxels;
  for (std::size_t i = 0; i < image.labels.size(); ++i) voxels[image.labels[i].value] = counts[i];
  for (Segment& segment : image.segments) segment.voxels = voxels[segment.label.value];
}

LabelImage read_file(const std::string& path, const LabelSelection& selection, std::size_t threads,
                     std::uint64_t most_bytes) {
  RawImage raw = read_raw(path, most_bytes);
  if (raw.slope != 1 || raw.intercept != 0)
    refuse(path, "a label image is needed (the header scales the voxels: scl_slope, scl_inter)");
  check_layers(path, selection, raw.segments.size(), raw.num_layers);
  const bool is_one_layer = raw.num_layers == 1;
  merge_layers(raw, selection, threads);
  LabelImage image = index_array(array_of(raw), raw.voxel_to_ras, path, threads);
  image.warnings = std::move(raw.warnings);
  image.segments = std::move(raw.segments);
  name_by_segments(image);
  if (is_one_layer) count_segments(image, threads);
  return image;
}

void refuse_layers(const std::string& path, const LabelSelection& selection) {
  check_layers(path, selection, 0, 1);
}

LabelImage read_phantom(const std::string& spec, int threads) {
  const std::string name = spec.substr(spec.find(':') + 1, spec.find('@') - spec.find(':') - 1);
  int size = kDefaultPhantomSize;
  if (const std::size_t at = spec.find('@'); at != std::string::npos) {
    const auto [end, error] = std::from_chars(spec.data() + at + 1, spec.data() + spec.size(), size);
    if (error != std::errc{} || end != spec.data() + spec.size())
      refuse(spec, "the size after @ is not a number");
  }
  return make_phantom(name, size, threads);
}

}  // namespace

RawImage read_raw(const std::string& path, std::uint64_t most_bytes) {
  if (has_ending(path, {".inr", ".inr.gz"})) return read_inr(path, most_bytes);
  if (has_ending(path, {".nii", ".nii.gz"})) return read_nifti(path, most_bytes);
  if (has_ending(path, {".nrrd", ".nhdr", ".mha", ".mhd"})) return read_with_itk(path, most_bytes);
  refuse(path, "unknown image format (known: .nii .nii.gz .nrrd .nhdr .mha .mhd .inr .inr.gz, phantom:NAME)");
}

LabelImage read_image(const std::string& path, const LabelSelection& selection, int threads,
                      std::uint64_t most_bytes) {
  const std::size_t used = num_threads(threads);
  const bool is_phantom = path.starts_with("phantom:");
  if (is_phantom) refuse_layers(path, selection);
  LabelImage image = is_phantom ? read_phantom(path, threads) : read_file(path, selection, used, most_bytes);
  select_labels(image, selection, path, used);
  return image;
}

LabelImage image_of_array(const VoxelArray& array, std::array<double, 12> voxel_to_ras,
                          const std::string& name, const LabelSelection& selection, int threads,
                          std::uint64_t most_bytes) {
  const std::size_t used = num_threads(threads);
  refuse_layers(name, selection);
  check_room(name, checked_num_voxels(name, array.size) * sizeof(LabelIndex), most_bytes);
  LabelImage image = index_array(array, voxel_to_ras, name, used);
  select_labels(image, selection, name, used);
  return image;
}

}  // namespace podm
