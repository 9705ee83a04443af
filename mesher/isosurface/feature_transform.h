// The nearest surface voxel of every voxel, by centers, in mm. It is exact, and is stored where the
// isosurface is near.
//
// A *surface voxel* has a 6-neighbor of another label. Voxels outside the grid count as background. The grid
// is cut into bricks of 4^3 voxels. A table has an entry of 8 bytes per brick:
//   A near brick has a surface voxel in its surroundings (brick_features.h), which include the brick itself.
//     The entry holds the position of the brick's words, and its label if it has no surface voxel.
//   A far brick is any other brick. All its voxels have one label: if two differed, two adjacent voxels on
//     the way between them would differ too. The entry holds that label and a lower bound of the distance,
//     box to box, between the brick and all bricks with surface voxels.
//
// A near brick has a 16-bit word per voxel: the offset to the voxel's feature, unless the feature is
// Surroundings::reach_mm() or more away. A surface voxel is its own feature, therefore its word is free and
// holds its label and the edges to neighbors of another label. After the words of a brick with surface voxels
// come their mask and their neighborhoods. One read of the table and one of a line of words and of
// neighborhoods therefore give the label and the shape of the isosurface.
//
// Where the voxels stay in the image's file (image_by_bricks.h), the words of near bricks are made when a
// query first needs them (unread_bricks.h). Until then their entries say so. The words are the same as those
// of the whole image, so all answers are. The labels of a brick with surface voxels are stored before its
// words.
//
// The bound is found as follows. A box of voxels contains all points whose nearest voxel is one of its
// voxels, and all isosurface points within half a voxel of its surface voxels. The distance between boxes is
// therefore a lower bound of the distance between such points. Along an axis, the boxes of bricks n > 0 apart
// have a gap of n - 1 bricks. The first brick is also n - 1 apart from the nearest of the three bricks around
// the second. The distance between boxes is therefore the distance to the nearest of all bricks that have
// surface voxels or touch a brick that has (brick_distances.h).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

#include "isosurface/brick_features.h"
#include "isosurface/eight_voxels.h"
#include "isosurface/neighborhood.h"
#include "isosurface/oracle_reads.h"
#include "isosurface/surface_tree.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// The table's entry of a brick.
class Brick {
 public:
  /// Not a label, as kMaxLabels is smaller.
  static constexpr LabelIndex kMixed = 0xffff;
  static constexpr std::uint16_t kMostSteps = 0xffff;

  static constexpr Brick near(std::uint32_t line, LabelIndex label) {
    return Brick(line | std::uint64_t{label} << 32);
  }
  static constexpr Brick far(LabelIndex label, std::uint16_t steps) {
    return Brick(std::uint64_t{label} << 32 | std::uint64_t{steps} << 48);
  }
  /// A near brick whose words have not been made.
  static constexpr Brick unread(LabelIndex label) { return near(kUnread, label); }
  constexpr explicit Brick(std::uint64_t word) : word_(word) {}

  constexpr bool is_unread() const { return line() == kUnread; }
  constexpr bool is_near() const { return line() != 0; }
  /// The position of the brick's words, in lines of 64 bytes.
  constexpr std::uint32_t line() const { return static_cast<std::uint32_t>(word_); }
  /// The label of all its voxels, or kMixed if the brick has surface voxels.
  constexpr LabelIndex label() const { return static_cast<LabelIndex>(word_ >> 32); }
  /// For a far brick: the least distance to the isosurface, in units of FeatureTransform::step_mm().
  constexpr std::uint16_t steps() const { return static_cast<std::uint16_t>(word_ >> 48); }
  constexpr std::uint64_t word() const { return word_; }

 private:
  static constexpr std::uint32_t kUnread = ~0u;

  std::uint64_t word_;
};

class UnreadBricks;

class FeatureTransform {
 public:
  /// Runs on `threads` threads (0: all cores). The result is the same for any number of threads. Throws
  /// InputError if the image has more than kMaxVoxels, or kMaxBricks if its voxels stay in the file.
  FeatureTransform(const LabelImage& image, int threads);
  ~FeatureTransform();
  /// The memory that the transform of an image takes while it is made, in bytes. Counting takes a tenth of
  /// the transform's time. The image must hold its voxels.
  static std::uint64_t num_bytes(const LabelImage& image, int threads);
  /// The largest num_bytes() of any image of this size.
  static std::uint64_t most_bytes(const LabelImage& image);

  const BrickGrid& bricks() const { return bricks_; }
  const SurfaceTree& tree() const { return tree_; }
  /// Infinite if the image has no surface voxels.
  double step_mm() const { return step_mm_; }
  double reach_mm() const { return reach_mm_; }
  /// The table, by brick, followed by the lines of words, which begin at the next multiple of eight.
  std::span<const std::uint64_t> words() const { return {&words_[0], num_words_}; }

  /// Makes the words of an unread brick, unless another thread has made them, and returns its entry. Throws
  /// InputError if the file cannot be read.
  Brick read_brick(std::size_t index) const;
  /// The memory of words that were made when they were first needed, in bytes.
  std::uint64_t bytes_read() const;

 private:
  BrickGrid bricks_;
  HugeArray<std::uint64_t> words_;
  std::size_t num_words_ = 0;
  SurfaceTree tree_;
  double step_mm_ = 0, reach_mm_ = 0;
  std::unique_ptr<UnreadBricks> unread_;  // null if the image holds its voxels
};

/// The data that the transform stores of a voxel: the entry of its brick, and its word.
class StoredFeature {
 public:
  /// `word` is 0 if the brick is far.
  constexpr StoredFeature(Brick brick, std::uint16_t word) : brick_(brick), word_(word) {}

  constexpr Brick brick() const { return brick_; }
  constexpr bool is_surface() const { return (word_ & kSurface) != 0; }
  /// The label of a surface voxel, or kLabelTooLarge if it does not fit in the word.
  constexpr LabelIndex label() const { return word_ & kLabelTooLarge; }
  static constexpr LabelIndex kLabelTooLarge = 0x1ff;
  /// The offset from the voxel to its feature; none if the word does not store it.
  constexpr std::optional<Voxel> offset() const {
    if (is_surface()) return Voxel{};
    const FeatureOffset offset(word_);
    return offset.is_beyond() ? std::nullopt : std::optional(offset.offset());
  }

  /// The word of a surface voxel: the top bit, its changing edges, and its label.
  static constexpr std::uint16_t kSurface = 0x8000;
  static constexpr int kEdgesAt = 9;
  static constexpr std::uint16_t word_of_surface(const Neighborhood& around, LabelIndex label) {
    return static_cast<std::uint16_t>(kSurface | around.changing_edges() << kEdgesAt |
                                      (label < kLabelTooLarge ? label : kLabelTooLarge));
  }

 private:
  Brick brick_;
  std::uint16_t word_;
};

/// Queries a transform, to which it keeps a reference. `Reads` receives each word that is read.
template <class Reads>
class Features {
 public:
  Features(const FeatureTransform& transform, const Reads& reads)
      : transform_(&transform),
        bricks_(transform.bricks()),
        words_(transform.words().data()),
        reads_(reads) {}

  bool is_empty() const { return transform_->tree().is_empty(); }
  Brick brick_of(const Voxel& v) const { return brick(bricks_.index_of_voxel(v)); }

  /// Visits the surface voxels near u, see SurfaceTree::visit().
  template <class Take>
  void visit(const Point& u, double& squared_reach, const Take& take) const {
    transform_->tree().visit(
        u, squared_reach,
        [&](const Voxel& at) { return surface_mask(brick(bricks_.index(at.i, at.j, at.k))); }, take);
  }
  /// The surface voxel whose center is nearest to u, if it lies within `reach_mm`. The search takes some
  /// microseconds.
  std::optional<Voxel> nearest(const Point& u, double reach_mm) const {
    std::optional<Voxel> nearest;
    double squared_reach = reach_mm * reach_mm;
    visit(u, squared_reach, [&](const Voxel& v, double squared) {
      if (nearest && squared == squared_reach) return;
      nearest = v;
      squared_reach = squared;
    });
    return nearest;
  }
  /// True if the center of a surface voxel lies within `reach_mm` of u. The search is shorter than that of
  /// nearest().
  bool is_surface_within(const Point& u, double reach_mm) const {
    constexpr double kEnd = -1;
    double squared_reach = reach_mm * reach_mm;
    visit(u, squared_reach, [&](const Voxel&, double) { squared_reach = kEnd; });
    return squared_reach == kEnd;
  }
  /// `v` must lie in `brick`.
  StoredFeature stored(Brick brick, const Voxel& v) const {
    return {brick, brick.is_near() ? word_at(brick, place_in_brick(v)) : std::uint16_t{0}};
  }
  /// The features of the corners of the box from `low` to `high`, which are at most one voxel apart along
  /// each axis; none if the words do not store all of them.
  std::optional<EightVoxels> nearest_to_corners(const Voxel& low, const Voxel& high) const {
    const std::optional<EightVoxels::Ints> stored = words_of_corners(low, high);
    if (!stored) return std::nullopt;
    const EightVoxels::Ints words = *stored, is_elsewhere = (words & StoredFeature::kSurface) == 0;
    const EightVoxels corners = EightVoxels::corners(low, high);
    return EightVoxels{corners.i + (is_elsewhere & FeatureOffset::along<0>(words)),
                       corners.j + (is_elsewhere & FeatureOffset::along<1>(words)),
                       corners.k + (is_elsewhere & FeatureOffset::along<2>(words))};
  }
  /// The edges of each of the surface voxels that change the label, as in Neighborhood::changing_edges().
  EightVoxels::Ints changing_edges(const EightVoxels& surface_voxels) const {
    const auto bricks = surface_voxels.bricks(bricks_), places = surface_voxels.places_in_bricks();
    EightVoxels::Ints words;
    for (unsigned c = 0; c < EightVoxels::kNum; ++c) words[c] = word_at(brick(bricks[c]), places[c]);
    return words >> StoredFeature::kEdgesAt & ((1 << kNumEdges) - 1);
  }
  /// A lower bound, mm, of the distance between the isosurface and any point whose nearest voxel lies in the
  /// far `brick`.
  double distance_from_far(Brick brick) const { return brick.steps() * transform_->step_mm(); }
  /// A lower bound, mm, of the distance by centers between a voxel of a near brick and any surface voxel, if
  /// the words do not store the voxel's feature.
  double reach_mm() const { return transform_->reach_mm(); }

  /// None if `v` is not a surface voxel.
  std::optional<Neighborhood> neighborhood_if_surface(const Voxel& v) const {
    const Brick brick = brick_of(v);
    if (brick.label() != Brick::kMixed) return std::nullopt;
    const std::uint64_t mask = surface_mask(brick);
    const unsigned place = place_in_brick(v);
    return (mask >> place & 1) != 0 ? std::optional(neighborhood_at(brick, mask, place)) : std::nullopt;
  }
  /// `v` must be a surface voxel in `brick`.
  Neighborhood neighborhood(Brick brick, const Voxel& v) const {
    return neighborhood_at(brick, surface_mask(brick), place_in_brick(v));
  }
  /// `v` must be a surface voxel.
  Neighborhood neighborhood(const Voxel& v) const { return neighborhood(brick_of(v), v); }

  /// The label of a voxel, if the voxels stay in the image's file.
  LabelIndex label(const Voxel& v) const {
    const Brick brick = brick_of(v);
    return brick.label() == Brick::kMixed ? label_in_mixed(brick, place_in_brick(v)) : brick.label();
  }

  /// Prefetches the line of v's word. Reads the table.
  void prefetch(const Voxel& v) const {
    const Brick brick(entry(bricks_.index_of_voxel(v)));
    __builtin_prefetch(bytes() + byte_of_word(brick, place_in_brick(v)));
  }

 private:
  friend class FeatureWriter;
  static constexpr std::size_t kLineBytes = 64, kBytesOfWords = 64 * sizeof(std::uint16_t);

  const std::byte* bytes() const { return reinterpret_cast<const std::byte*>(words_); }
  template <class T>
  T read(std::size_t byte) const {
    reads_.transform(byte / sizeof(std::uint64_t));
    T value;
    std::memcpy(&value, bytes() + byte, sizeof value);
    return value;
  }
  // Another thread may store the entry after it has made the brick's words.
  std::uint64_t entry(std::size_t index) const { return __atomic_load_n(words_ + index, __ATOMIC_ACQUIRE); }
  Brick brick(std::size_t index) const {
    reads_.transform(index);
    const Brick brick(entry(index));
    if (brick.is_unread()) [[unlikely]]
      return transform_->read_brick(index);
    return brick;
  }
  // The labels lie before the words.
  LabelIndex label_in_mixed(Brick brick, unsigned place) const {
    return read<LabelIndex>(byte_of_word(brick, place) - kBytesOfWords);
  }
  static std::size_t byte_of_word(Brick brick, unsigned place) {
    return brick.line() * kLineBytes + sizeof(std::uint16_t) * place;
  }
  std::uint16_t word_at(Brick brick, unsigned place) const {
    return read<std::uint16_t>(byte_of_word(brick, place));
  }
  // The words of two corners along x are adjacent unless a brick ends between them.
  std::optional<EightVoxels::Ints> words_of_corners(const Voxel& low, const Voxel& high) const {
    const std::size_t first = bricks_.index_of_voxel(low),
                      up_y = bricks_.index_of_voxel({low.i, high.j, low.k}) - first,
                      up_z = bricks_.index_of_voxel({low.i, low.j, high.k}) - first;
    const unsigned place = place_in_brick(low), place_y = place_in_brick({low.i, high.j, low.k}) - place,
                   place_z = place_in_brick({low.i, low.j, high.k}) - place;
    using Pairs [[gnu::vector_size(16)]] = std::uint32_t;
    using Words [[gnu::vector_size(16)]] = std::uint16_t;
    using Halves [[gnu::vector_size(16)]] = std::uint64_t;
    const auto read_pairs = [&](const auto& pair) {
      return Pairs{pair(first, place), pair(first + up_y, place + place_y),
                   pair(first + up_z, place + place_z), pair(first + up_y + up_z, place + place_y + place_z)};
    };
    const auto word = [&](std::size_t brick_index, unsigned at) -> std::uint32_t {
      const Brick of_word = brick(brick_index);
      return of_word.is_near() ? word_at(of_word, at) : 0;
    };
    Pairs pairs;
    if ((low.i & 3) != 3 && low.i != high.i) {
      pairs = read_pairs([&](std::size_t brick_index, unsigned at) -> std::uint32_t {
        const Brick of_words = brick(brick_index);
        return of_words.is_near() ? read<std::uint32_t>(byte_of_word(of_words, at)) : 0;
      });
    } else {
      const auto right = static_cast<unsigned>(high.i - low.i);
      pairs = read_pairs([&](std::size_t brick_index, unsigned at) {
        return word(brick_index, at) | word(brick_index + right, at - 3 * right) << 16;
      });
    }
    const auto words = reinterpret_cast<Words>(pairs);
    const auto is_beyond = reinterpret_cast<Halves>(words == 0);
    if ((is_beyond[0] | is_beyond[1]) != 0) return std::nullopt;
    return __builtin_convertvector(words, EightVoxels::Ints);
  }
  static std::size_t byte_of_mask(Brick brick) { return brick.line() * kLineBytes + kBytesOfWords; }
  std::uint64_t surface_mask(Brick brick) const { return read<std::uint64_t>(byte_of_mask(brick)); }
  Neighborhood neighborhood_at(Brick brick, std::uint64_t mask, unsigned place) const {
    const auto num_before = static_cast<std::size_t>(std::popcount(mask & ((std::uint64_t{1} << place) - 1)));
    return Neighborhood(
        read<std::uint32_t>(byte_of_mask(brick) + sizeof mask + sizeof(std::uint32_t) * num_before));
  }

  const FeatureTransform* transform_;
  BrickGrid bricks_;
  const std::uint64_t* words_;
  [[no_unique_address]] Reads reads_;
};

}  // namespace podm
