#include "image/index_voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
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

// Small integers index an array of all possible values. Other values come in runs of equal ones, therefore
// the last value is remembered.
template <class Voxel>
constexpr bool kIsSmall = sizeof(Voxel) <= 2;
constexpr std::size_t kNumSmall = 1 << 16;

template <class Voxel>
bool is_label(Voxel voxel) {
  constexpr double kEnd = 4294967296.0;
  const auto value = static_cast<double>(voxel);
  return value >= 0 && value < kEnd && std::floor(value) == value;  // NaN is not a label
}

template <class Voxel>
Voxel voxel_at(const char* place) {
  Voxel voxel;
  std::memcpy(&voxel, place, sizeof voxel);
  return voxel;
}

// True if the voxels follow each other without gaps, x fastest.
bool is_dense(const VoxelArray& array) {
  auto expected = static_cast<std::ptrdiff_t>(bytes_of(array.type));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (array.strides_bytes[axis] != expected) return false;
    expected *= array.size[axis];
  }
  return true;
}

const char* first_of(const VoxelArray& array) { return static_cast<const char*>(array.first); }

// Cuts an array of any strides into blocks. Within a block neither the array's voxels nor the image's are far
// apart in memory.
class Blocks {
 public:
  explicit Blocks(const VoxelArray& array) : array_(array), image_strides_{1, array.size[0], 0} {
    image_strides_[2] = image_strides_[1] * array.size[1];
    for (std::size_t axis = 0; axis < 3; ++axis)
      numbers_[axis] = array.size[axis] / kSide + (array.size[axis] % kSide != 0);
    std::sort(axes_.begin(), axes_.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(array.strides_bytes[a]) < std::abs(array.strides_bytes[b]);
    });
  }

  std::size_t count() const {
    return static_cast<std::size_t>(numbers_[0]) * static_cast<std::size_t>(numbers_[1]) *
           static_cast<std::size_t>(numbers_[2]);
  }

  /// Calls use(position in the image, place in the array) for every voxel of the block.
  template <class Use>
  void for_each_voxel(std::size_t block, const Use& use) const {
    std::array<int, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto number = static_cast<std::size_t>(numbers_[axis]);
      low[axis] = static_cast<int>(block % number) * kSide;
      high[axis] = std::min(low[axis] + kSide, array_.size[axis]);
      block /= number;
    }
    const auto [fast, middle, slow] = axes_;
    for (std::array<int, 3> at = low; at[slow] < high[slow]; ++at[slow])
      for (at[middle] = low[middle]; at[middle] < high[middle]; ++at[middle]) {
        at[fast] = low[fast];
        const char* place = first_of(array_) + dot(at, array_.strides_bytes);
        std::ptrdiff_t position = dot(at, image_strides_);
        for (int i = low[fast]; i < high[fast]; ++i) {
          use(static_cast<std::size_t>(position), place);
          place += array_.strides_bytes[fast];
          position += image_strides_[fast];
        }
      }
  }

 private:
  static constexpr int kSide = 32;

  static std::ptrdiff_t dot(const std::array<int, 3>& at, const std::array<std::ptrdiff_t, 3>& strides) {
    return at[0] * strides[0] + at[1] * strides[1] + at[2] * strides[2];
  }

  const VoxelArray& array_;
  std::array<std::ptrdiff_t, 3> image_strides_;
  std::array<int, 3> numbers_{};
  std::array<std::size_t, 3> axes_{0, 1, 2};  // axes by the array's strides, the shortest first
};

// Throws InputError that names the first voxel whose value is not a label. There must be such a voxel.
template <class Voxel>
[[noreturn]] void refuse_first_without_label(const VoxelArray& array, const std::string& path,
                                             const podm::Voxel& first) {
  for (int k = 0; k < array.size[2]; ++k)
    for (int j = 0; j < array.size[1]; ++j)
      for (int i = 0; i < array.size[0]; ++i) {
        const auto& strides = array.strides_bytes;
        const auto voxel =
            voxel_at<Voxel>(first_of(array) + i * strides[0] + j * strides[1] + k * strides[2]);
        if (is_label(voxel)) continue;
        refuse(path, "a label image is needed: voxel (" + std::to_string(first.i + i) + ", " +
                         std::to_string(first.j + j) + ", " + std::to_string(first.k + k) + ") is " +
                         std::to_string(voxel) + ", no label (an integer, 0 to 2^32 - 1)");
      }
  refuse(path, "its voxels changed during reading");
}

// The different voxel values that one thread meets, as long as they are not too many and all are labels.
// Values that differ from themselves (NaN) are not inserted: a set of them would take forever.
template <class Voxel>
class VoxelSet {
 public:
  /// Adds voxels of a dense array.
  void add(const char* voxels, std::size_t begin, std::size_t end) {
    for_each_stretch(voxels, sizeof(Voxel), begin, end,
                     [&](std::size_t from, std::size_t to, bool is_uniform) {
                       if (!has_other_) add_all(voxels, from, is_uniform ? from + 1 : to);
                     });
  }

  void add(Voxel voxel) {
    if constexpr (kIsSmall<Voxel>) {
      is_met_[static_cast<std::uint16_t>(voxel)] = true;
    } else if (last_ != voxel && !has_other_) {
      has_other_ = !is_label(voxel);
      last_ = voxel;
      if (!has_other_ && met_.size() <= kMostValues) met_.insert(voxel);
    }
  }

  /// True if a large voxel was met that is not a label. The voxels after it are not examined.
  bool has_other() const { return has_other_; }

  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t i = 0; i < is_met_.size(); ++i)
      if (is_met_[i]) use(static_cast<Voxel>(i));
    for (const Voxel voxel : met_) use(voxel);
  }

 private:
  void add_all(const char* voxels, std::size_t begin, std::size_t end) {
    char* const is_met = is_met_.data();  // a char may alias the pointer in the vector
    for (std::size_t i = begin; i < end; ++i) {
      const auto voxel = voxel_at<Voxel>(voxels + i * sizeof(Voxel));
      if constexpr (kIsSmall<Voxel>) {
        is_met[static_cast<std::uint16_t>(voxel)] = true;
      } else {
        add(voxel);
      }
    }
  }

  std::vector<char> is_met_ = std::vector<char>(kIsSmall<Voxel> ? kNumSmall : 0);
  std::optional<Voxel> last_;
  std::unordered_set<Voxel> met_;
  bool has_other_ = false;
};

// The position of a voxel's value in `values`; 0 if the voxel has changed in the meantime to another value.
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
      const auto value = static_cast<std::uint32_t>(voxel);
      const auto found = std::lower_bound(values_.begin(), values_.end(), value);
      const bool is_value = found != values_.end() && *found == value;
      last_position_ = is_value ? static_cast<LabelIndex>(found - values_.begin()) : LabelIndex{0};
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
std::vector<std::uint32_t> different_values(const VoxelArray& array, const std::string& path,
                                            const podm::Voxel& first, std::size_t num_voxels,
                                            std::size_t threads) {
  std::vector<VoxelSet<Voxel>> met(threads);
  if (is_dense(array)) {
    parallel_for_ranges(num_voxels, kChunk, threads,
                        [&](std::size_t begin, std::size_t end, std::size_t thread) {
                          met[thread].add(first_of(array), begin, end);
                        });
  } else {
    const Blocks blocks(array);
    parallel_for(blocks.count(), threads, [&](std::size_t block, std::size_t thread) {
      blocks.for_each_voxel(block,
                            [&](std::size_t, const char* place) { met[thread].add(voxel_at<Voxel>(place)); });
    });
  }
  std::set<std::uint32_t> values;
  for (const VoxelSet<Voxel>& set : met) {
    if (set.has_other()) refuse_first_without_label<Voxel>(array, path, first);
    set.for_each([&](Voxel voxel) {
      if (!is_label(voxel)) refuse_first_without_label<Voxel>(array, path, first);
      values.insert(static_cast<std::uint32_t>(voxel));
    });
  }
  if (values.size() > kMostValues)
    refuse(path, "a label image is needed: more than " + std::to_string(kMostValues) + " different values");
  return {values.begin(), values.end()};
}

// Indexes a range of voxels of a dense array.
template <class Voxel>
void index_range(const char* array, std::size_t begin, std::size_t end, Positions<Voxel>& position,
                 LabelIndex* voxels) {
  const auto position_of = [&](std::size_t i) {
    return position(voxel_at<Voxel>(array + i * sizeof(Voxel)));
  };
  for_each_stretch(array, sizeof(Voxel), begin, end, [&](std::size_t from, std::size_t to, bool is_uniform) {
    if (is_uniform) {
      std::fill(voxels + from, voxels + to, position_of(from));
    } else {
      for (std::size_t i = from; i < to; ++i) voxels[i] = position_of(i);
    }
  });
}

template <class Voxel>
void index(const VoxelArray& array, const std::string& path, const podm::Voxel& first, std::size_t threads,
           LabelImage& image) {
  const std::vector<std::uint32_t> values =
      different_values<Voxel>(array, path, first, image.num_voxels(), threads);
  for (const std::uint32_t value : values) image.labels.push_back({value, {}});
  std::vector<Positions<Voxel>> positions(threads, Positions<Voxel>(values));
  parallel_resize(image.voxels, image.num_voxels(), threads);
  LabelIndex* const voxels = image.voxels.data();
  if (is_dense(array)) {
    parallel_for_ranges(image.num_voxels(), kChunk, threads,
                        [&](std::size_t begin, std::size_t end, std::size_t thread) {
                          index_range(first_of(array), begin, end, positions[thread], voxels);
                        });
  } else {
    const Blocks blocks(array);
    parallel_for(blocks.count(), threads, [&](std::size_t block, std::size_t thread) {
      blocks.for_each_voxel(block, [&](std::size_t i, const char* place) {
        voxels[i] = positions[thread](voxel_at<Voxel>(place));
      });
    });
  }
}

}  // namespace

void index_voxels(const VoxelArray& array, const std::string& path, std::size_t threads, LabelImage& image,
                  const Voxel& first) {
  with_voxel_type(array.type,
                  [&](auto voxel) { index<decltype(voxel)>(array, path, first, threads, image); });
}

}  // namespace podm
