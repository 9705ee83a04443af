// From a path to a label image: pick the reader, turn voxels into label values, select, index densely.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

#include "image/read_formats.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

constexpr int kDefaultPhantomSize = 256;

bool ends_with(const std::string& path, const std::string& ending) {
  return path.size() >= ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

RawImage read_raw(const std::string& path) {
  for (const char* ending : {".inr", ".inr.gz"}) {
    if (ends_with(path, ending)) return read_inr(path);
  }
  for (const char* ending : {".nrrd", ".nhdr", ".mha", ".mhd"}) {
    if (ends_with(path, ending)) {
      check_exists(path);
      return read_with_itk(path);
    }
  }
  if (is_nifti_name(path)) {
    check_exists(path);
    return read_with_itk(path);
  }
  refuse(
      path,
      "unknown image format (known: .nii .nii.gz .hdr .img .nrrd .nhdr .mha .mhd .inr .inr.gz phantom:NAME)");
}

// Label values of one voxel type, in order of appearance, and their dense indices. Runs of equal voxels are
// the rule, so the last value is remembered.
class Indexer {
 public:
  template <class Voxel>
  void index(const std::string& path, const std::vector<unsigned char>& bytes, std::vector<LabelIndex>& out) {
    Voxel last{};
    LabelIndex last_index = index_of(path, value_of(path, last));
    for (std::size_t i = 0; i < out.size(); ++i) {
      Voxel v;
      std::memcpy(&v, bytes.data() + i * sizeof(Voxel), sizeof(Voxel));
      if (v != last) {
        last_index = index_of(path, value_of(path, v));
        last = v;
      }
      out[i] = last_index;
      ++counts[last_index];
    }
  }

  std::vector<std::uint32_t> values;
  std::vector<std::uint64_t> counts;

 private:
  template <class Voxel>
  static std::uint32_t value_of(const std::string& path, Voxel v) {
    constexpr double kEnd = 4294967296.0;
    const auto x = static_cast<double>(v);
    if (!(x >= 0 && x < kEnd))
      refuse(path, "a label image is needed: value " + std::to_string(x) + " is no label (0 to 2^32 - 1)");
    if (std::floor(x) != x)
      refuse(path, "a label image is needed: value " + std::to_string(x) + " is not integral");
    return static_cast<std::uint32_t>(x);
  }
  LabelIndex index_of(const std::string& path, std::uint32_t value) {
    const auto known = index_of_value_.find(value);
    if (known != index_of_value_.end()) return known->second;
    if (values.size() > kMaxLabels) {
      refuse(path, "a label image is needed: more than " + std::to_string(kMaxLabels) + " different values");
    }
    values.push_back(value);
    counts.push_back(0);
    const auto index = static_cast<LabelIndex>(values.size() - 1);
    index_of_value_[value] = index;
    return index;
  }
  std::unordered_map<std::uint32_t, LabelIndex> index_of_value_;
};

void index_voxels(const RawImage& raw, Indexer& indexer, std::vector<LabelIndex>& out) {
  const auto run = [&]<class Voxel>(Voxel) { indexer.index<Voxel>(raw.path, raw.bytes, out); };
  switch (raw.type) {
    case VoxelType::kUint8:
      return run(std::uint8_t{});
    case VoxelType::kInt8:
      return run(std::int8_t{});
    case VoxelType::kUint16:
      return run(std::uint16_t{});
    case VoxelType::kInt16:
      return run(std::int16_t{});
    case VoxelType::kUint32:
      return run(std::uint32_t{});
    case VoxelType::kInt32:
      return run(std::int32_t{});
    case VoxelType::kUint64:
      return run(std::uint64_t{});
    case VoxelType::kInt64:
      return run(std::int64_t{});
    case VoxelType::kFloat:
      return run(float{});
    case VoxelType::kDouble:
      return run(double{});
  }
}

bool contains(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& ranges, std::uint32_t value) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [=](const auto& r) { return r.first <= value && value <= r.second; });
}

void check_present(const std::string& path, const std::vector<std::uint32_t>& values, std::uint32_t asked,
                   const char* option) {
  if (std::find(values.begin(), values.end(), asked) == values.end()) {
    refuse(path, std::string(option) + ": label " + std::to_string(asked) + " is not in the image");
  }
}

void check_selection(const std::string& path, const std::vector<std::uint32_t>& values,
                     const LabelSelection& selection) {
  for (const auto& [low, high] : selection.keep) {
    if (low == high) check_present(path, values, low, "--labels");
  }
  for (const auto& [low, high] : selection.drop) {
    if (low == high) check_present(path, values, low, "--drop");
  }
  for (const auto& merge : selection.merges) {
    for (const std::uint32_t value : merge.values) check_present(path, values, value, "--merge");
  }
}

// The value a stored value becomes; the background's own for what is not kept.
std::uint32_t selected_value(std::uint32_t value, const LabelSelection& selection) {
  if (value == selection.background || (!selection.keep.empty() && !contains(selection.keep, value)) ||
      contains(selection.drop, value)) {
    return selection.background;
  }
  for (const auto& merge : selection.merges) {
    if (std::find(merge.values.begin(), merge.values.end(), value) != merge.values.end())
      return merge.values[0];
  }
  return value;
}

// Renumbers `voxels`, which hold positions in `stored`, by ascending selected value; labels[0] is the
// background.
void select(LabelImage& image, const std::string& path, const std::vector<Label>& stored,
            const std::vector<std::uint64_t>& counts, const LabelSelection& selection) {
  std::vector<std::uint32_t> values;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (counts[i] > 0) values.push_back(stored[i].value);
  }
  check_selection(path, values, selection);
  std::map<std::uint32_t, std::string> kept;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const std::uint32_t value = selected_value(stored[i].value, selection);
    if (counts[i] > 0 && value != selection.background && stored[i].value == value)
      kept[value] = stored[i].name;
  }
  for (const auto& merge : selection.merges) {
    const auto merged = kept.find(merge.values[0]);
    if (merged != kept.end() && !merge.name.empty()) merged->second = merge.name;
  }
  if (kept.empty()) refuse(path, "no foreground: every voxel is background or deselected");
  image.labels = {{selection.background, ""}};
  std::map<std::uint32_t, LabelIndex> index_of_value{{selection.background, kBackground}};
  for (const auto& [value, name] : kept) {
    index_of_value[value] = static_cast<LabelIndex>(image.labels.size());
    image.labels.push_back({value, name});
  }
  std::vector<LabelIndex> table;
  for (const Label& label : stored) {
    const auto known = index_of_value.find(selected_value(label.value, selection));
    table.push_back(known == index_of_value.end() ? kBackground : known->second);
  }
  for (LabelIndex& voxel : image.voxels) voxel = table[voxel];
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
  if (path.starts_with("phantom:")) {
    LabelImage image = read_phantom(path);
    const std::vector<Label> stored = image.labels;
    std::vector<std::uint64_t> counts(stored.size(), 0);
    for (const LabelIndex voxel : image.voxels) ++counts[voxel];
    select(image, path, stored, counts, selection);
    return image;
  }
  RawImage raw = read_raw(path);
  LabelImage image;
  image.size = {raw.size[0], raw.size[1], raw.size[2]};
  image.spacing = checked_spacing(path, raw.voxel_to_ras);
  image.voxel_to_ras = raw.voxel_to_ras;
  image.voxels.resize(image.num_voxels());
  Indexer indexer;
  index_voxels(raw, indexer, image.voxels);
  raw.bytes = {};
  std::vector<Label> stored;
  for (const std::uint32_t value : indexer.values) stored.push_back({value, ""});
  select(image, path, stored, indexer.counts, selection);
  return image;
}

}  // namespace podm
