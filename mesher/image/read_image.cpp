// From a path to a label image: pick the reader, turn voxels into label values, select.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <unordered_map>

#include "image/label_selection.h"
#include "image/read_formats.h"
#include "podm/image_io.h"

namespace podm {

namespace {

constexpr int kDefaultPhantomSize = 256;

bool has_ending(const std::string& path, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return path.ends_with(ending); });
}

RawImage read_raw(const std::string& path) {
  if (has_ending(path, {".inr", ".inr.gz"})) return read_inr(path);
  if (has_ending(path, {".nii", ".nii.gz"})) return read_nifti(path);
  if (has_ending(path, {".nrrd", ".nhdr", ".mha", ".mhd"})) return read_with_itk(path);
  refuse(path, "unknown image format (known: .nii .nii.gz .nrrd .nhdr .mha .mhd .inr .inr.gz, phantom:NAME)");
}

template <class Voxel>
std::uint32_t label_value(Voxel voxel, const std::string& path) {
  constexpr double kEnd = 4294967296.0;
  const auto value = static_cast<double>(voxel);
  if (!(value >= 0 && value < kEnd))
    refuse(path, "a label image is needed: value " + std::to_string(value) + " is no label (0 to 2^32 - 1)");
  if (std::floor(value) != value)
    refuse(path, "a label image is needed: value " + std::to_string(value) + " is not integral");
  return static_cast<std::uint32_t>(value);
}

// Gives each new value the next place in `labels`.
class ValueIndex {
 public:
  ValueIndex(std::vector<Label>& labels, const std::string& path) : labels_(labels), path_(path) {}

  LabelIndex operator()(std::uint32_t value) {
    const auto [known, is_new] = index_.try_emplace(value, static_cast<LabelIndex>(labels_.size()));
    if (!is_new) return known->second;
    constexpr std::size_t kMostValues = std::numeric_limits<LabelIndex>::max();
    if (labels_.size() == kMostValues)
      refuse(path_,
             "a label image is needed: more than " + std::to_string(kMostValues) + " different values");
    labels_.push_back({value, {}});
    return known->second;
  }

 private:
  std::vector<Label>& labels_;
  const std::string& path_;
  std::unordered_map<std::uint32_t, LabelIndex> index_;
};

// Small integers find their index in an array. Others come in runs of equal voxels: the last is remembered.
template <class Voxel>
void index_voxels(const RawImage& raw, LabelImage& image) {
  constexpr LabelIndex kUnseen = std::numeric_limits<LabelIndex>::max();
  constexpr bool kIsSmall = sizeof(Voxel) <= 2;
  std::vector<LabelIndex> seen(kIsSmall ? 1 << 16 : 0, kUnseen);
  ValueIndex index_of(image.labels, raw.path);
  Voxel last{};
  LabelIndex last_index = kUnseen;
  for (std::size_t i = 0; i < image.voxels.size(); ++i) {
    Voxel voxel;
    std::memcpy(&voxel, raw.bytes.data() + i * sizeof voxel, sizeof voxel);
    if constexpr (kIsSmall) {
      LabelIndex& index = seen[static_cast<std::uint16_t>(voxel)];
      if (index == kUnseen) index = index_of(label_value(voxel, raw.path));
      image.voxels[i] = index;
    } else {
      if (last_index == kUnseen || voxel != last) {
        last_index = index_of(label_value(voxel, raw.path));
        last = voxel;
      }
      image.voxels[i] = last_index;
    }
  }
}

void index_voxels(const RawImage& raw, LabelImage& image) {
  switch (raw.type) {
    case VoxelType::kUint8:
      return index_voxels<std::uint8_t>(raw, image);
    case VoxelType::kInt8:
      return index_voxels<std::int8_t>(raw, image);
    case VoxelType::kUint16:
      return index_voxels<std::uint16_t>(raw, image);
    case VoxelType::kInt16:
      return index_voxels<std::int16_t>(raw, image);
    case VoxelType::kUint32:
      return index_voxels<std::uint32_t>(raw, image);
    case VoxelType::kInt32:
      return index_voxels<std::int32_t>(raw, image);
    case VoxelType::kUint64:
      return index_voxels<std::uint64_t>(raw, image);
    case VoxelType::kInt64:
      return index_voxels<std::int64_t>(raw, image);
    case VoxelType::kFloat:
      return index_voxels<float>(raw, image);
    case VoxelType::kDouble:
      return index_voxels<double>(raw, image);
  }
}

// Voxels index the values in the order met; which is the background is not known yet.
LabelImage read_file(const std::string& path) {
  RawImage raw = read_raw(path);
  LabelImage image;
  image.size = {raw.size[0], raw.size[1], raw.size[2]};
  image.spacing = checked_spacing(path, raw.voxel_to_ras);
  image.voxel_to_ras = raw.voxel_to_ras;
  image.voxels.resize(image.num_voxels());
  index_voxels(raw, image);
  return image;
}

LabelImage read_phantom(const std::string& spec) {
  const std::string name = spec.substr(spec.find(':') + 1, spec.find('@') - spec.find(':') - 1);
  int size = kDefaultPhantomSize;
  if (const std::size_t at = spec.find('@'); at != std::string::npos) {
    const auto [end, error] = std::from_chars(spec.data() + at + 1, spec.data() + spec.size(), size);
    if (error != std::errc{} || end != spec.data() + spec.size())
      refuse(spec, "the size after @ is not a number");
  }
  return make_phantom(name, size);
}

}  // namespace

LabelImage read_image(const std::string& path, const LabelSelection& selection) {
  LabelImage image = path.starts_with("phantom:") ? read_phantom(path) : read_file(path);
  select_labels(image, selection, path);
  return image;
}

}  // namespace podm
