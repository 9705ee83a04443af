#include "image/index_voxels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <unordered_set>

#include "image/stretches.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_resize.h"

namespace podm {

namespace {

constexpr std::size_t kChunk = 1 << 18;  // voxels
constexpr std::size_t kMostValues = std::numeric_limits<LabelIndex>::max();

// Small integers index an array of all there are. Others come in runs of equal ones: the last is remembered.
template <class Voxel>
constexpr bool kIsSmall = sizeof(Voxel) <= 2;
constexpr std::size_t kNumSmall = 1 << 16;

template <class Voxel>
bool is_label(Voxel voxel) {
  constexpr double kEnd = 4294967296.0;
  const auto value = static_cast<double>(voxel);
  return value >= 0 && value < kEnd && std::floor(value) == value;  // NaN is none
}

template <class Voxel>
Voxel voxel_at(const RawImage& raw, std::size_t i) {
  Voxel voxel;
  std::memcpy(&voxel, raw.bytes.data() + i * sizeof voxel, sizeof voxel);
  return voxel;
}

// Names the first voxel whose value is no label; there must be one.
template <class Voxel>
[[noreturn]] void refuse_first_without_label(const RawImage& raw) {
  std::size_t i = 0;
  while (is_label(voxel_at<Voxel>(raw, i))) ++i;
  const auto num_x = static_cast<std::size_t>(raw.size[0]), num_y = static_cast<std::size_t>(raw.size[1]);
  refuse(raw.path, "a label image is needed: voxel (" + std::to_string(i % num_x) + ", " +
                       std::to_string(i / num_x % num_y) + ", " + std::to_string(i / num_x / num_y) +
                       ") is " + std::to_string(voxel_at<Voxel>(raw, i)) +
                       ", no label (an integer, 0 to 2^32 - 1)");
}

// The different voxels that one thread meets, while they are not too many and all are labels: a set of values
// that differ from themselves would take forever.
template <class Voxel>
class VoxelSet {
 public:
  void add(const RawImage& raw, std::size_t begin, std::size_t end) {
    for_each_stretch(raw.bytes.data(), sizeof(Voxel), begin, end,
                     [&](std::size_t from, std::size_t to, bool is_uniform) {
                       if (!has_other_) add_all(raw, from, is_uniform ? from + 1 : to);
                     });
  }

  /// Whether a large voxel was met that is no label; what comes after it is not looked at.
  bool has_other() const { return has_other_; }

  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t i = 0; i < is_met_.size(); ++i)
      if (is_met_[i]) use(static_cast<Voxel>(i));
    for (const Voxel voxel : met_) use(voxel);
  }

 private:
  void add_all(const RawImage& raw, std::size_t begin, std::size_t end) {
    char* const is_met = is_met_.data();  // a char may alias the pointer in the vector
    for (std::size_t i = begin; i < end; ++i) {
      const auto voxel = voxel_at<Voxel>(raw, i);
      if constexpr (kIsSmall<Voxel>) {
        is_met[static_cast<std::uint16_t>(voxel)] = true;
      } else if (last_ != voxel) {
        if (!is_label(voxel)) {
          has_other_ = true;
          return;
        }
        last_ = voxel;
        if (met_.size() <= kMostValues) met_.insert(voxel);
      }
    }
  }

  std::vector<char> is_met_ = std::vector<char>(kIsSmall<Voxel> ? kNumSmall : 0);
  std::optional<Voxel> last_;
  std::unordered_set<Voxel> met_;
  bool has_other_ = false;
};

// The position of a voxel that is a value, among the values.
template <class Voxel>
class Positions {
 public:
  explicit Positions(const std::vector<std::uint32_t>& values)
      : values_(values), small_(kIsSmall<Voxel> ? kNumSmall : 0) {
    if constexpr (kIsSmall<Voxel>) {
      for (std::size_t i = 0; i < values.size(); ++i)
        small_[static_cast<std::uint16_t>(values[i])] = static_cast<LabelIndex>(i);
    }
  }

  LabelIndex operator()(Voxel voxel) {
    if constexpr (kIsSmall<Voxel>) return small_[static_cast<std::uint16_t>(voxel)];
    if (last_ != voxel) {
      last_ = voxel;
      last_position_ = static_cast<LabelIndex>(
          std::lower_bound(values_.begin(), values_.end(), static_cast<std::uint32_t>(voxel)) -
          values_.begin());
    }
    return last_position_;
  }

 private:
  const std::vector<std::uint32_t>& values_;
  std::vector<LabelIndex> small_;
  std::optional<Voxel> last_;
  LabelIndex last_position_ = 0;
};

template <class Voxel>
std::vector<std::uint32_t> different_values(const RawImage& raw, std::size_t threads) {
  std::vector<VoxelSet<Voxel>> met(threads);
  parallel_for_ranges(
      raw.bytes.size() / sizeof(Voxel), kChunk, threads,
      [&](std::size_t begin, std::size_t end, std::size_t thread) { met[thread].add(raw, begin, end); });
  std::set<std::uint32_t> values;
  for (const VoxelSet<Voxel>& set : met) {
    if (set.has_other()) refuse_first_without_label<Voxel>(raw);
    set.for_each([&](Voxel voxel) {
      if (!is_label(voxel)) refuse_first_without_label<Voxel>(raw);
      values.insert(static_cast<std::uint32_t>(voxel));
    });
  }
  if (values.size() > kMostValues)
    refuse(raw.path,
           "a label image is needed: more than " + std::to_string(kMostValues) + " different values");
  return {values.begin(), values.end()};
}

template <class Voxel>
void index_range(const RawImage& raw, std::size_t begin, std::size_t end, Positions<Voxel>& position,
                 LabelIndex* voxels) {
  for_each_stretch(raw.bytes.data(), sizeof(Voxel), begin, end,
                   [&](std::size_t from, std::size_t to, bool is_uniform) {
                     if (is_uniform) {
                       std::fill(voxels + from, voxels + to, position(voxel_at<Voxel>(raw, from)));
                     } else {
                       for (std::size_t i = from; i < to; ++i) voxels[i] = position(voxel_at<Voxel>(raw, i));
                     }
                   });
}

template <class Voxel>
void index(const RawImage& raw, std::size_t threads, LabelImage& image) {
  const std::vector<std::uint32_t> values = different_values<Voxel>(raw, threads);
  for (const std::uint32_t value : values) image.labels.push_back({value, {}});
  std::vector<Positions<Voxel>> positions(threads, Positions<Voxel>(values));
  parallel_resize(image.voxels, image.num_voxels(), threads);
  parallel_for_ranges(image.voxels.size(), kChunk, threads,
                      [&](std::size_t begin, std::size_t end, std::size_t thread) {
                        index_range(raw, begin, end, positions[thread], image.voxels.data());
                      });
}

}  // namespace

void index_voxels(const RawImage& raw, std::size_t threads, LabelImage& image) {
  switch (raw.type) {
    case VoxelType::kUint8:
      return index<std::uint8_t>(raw, threads, image);
    case VoxelType::kInt8:
      return index<std::int8_t>(raw, threads, image);
    case VoxelType::kUint16:
      return index<std::uint16_t>(raw, threads, image);
    case VoxelType::kInt16:
      return index<std::int16_t>(raw, threads, image);
    case VoxelType::kUint32:
      return index<std::uint32_t>(raw, threads, image);
    case VoxelType::kInt32:
      return index<std::int32_t>(raw, threads, image);
    case VoxelType::kUint64:
      return index<std::uint64_t>(raw, threads, image);
    case VoxelType::kInt64:
      return index<std::int64_t>(raw, threads, image);
    case VoxelType::kFloat:
      return index<float>(raw, threads, image);
    case VoxelType::kDouble:
      return index<double>(raw, threads, image);
  }
}

}  // namespace podm
