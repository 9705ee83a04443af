// For every voxel the nearest surface voxel, by centres, in mm: exactly, and stored where the isosurface is
// near.
//
// A *surface voxel* has a 6-neighbour of another label; outside the grid counts as background. The grid is
// cut into bricks of 4^3 voxels, of which a table tells, 8 bytes each:
//   A near brick: one of its surroundings (brick_features.h), itself included, has a surface voxel. The table
//     has where its words lie, and its label if it has just one.
//   A far brick: the others. All its voxels have one label (two that differ have two beside each other on the
//     way), and the table has it, with a lower bound of the distance between the brick and all bricks with
//     surface voxels, box to box.
// A near brick's words are 16 bits for each voxel: the offset to its feature, unless that is
// Surroundings::reach_mm() or more away. A surface voxel is its own feature, which leaves its word free: it
// tells its label. After the words of a brick with surface voxels come their mask and their neighborhoods. So
// a look at the table and one at a line of words and of neighborhoods give the label and the shape of the
// isosurface.
//
// A box of voxels holds all points of which one of its voxels is the nearest, and all isosurface points
// within half a voxel of its surface voxels. So the distance of boxes bounds that of points. Along an axis
// boxes of bricks n > 0 apart are n - 1 bricks apart, as is the first from the nearest of the three around
// the second. So it is the distance to the nearest of all bricks beside those with surface voxels
// (brick_distances.h).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

/// What the table tells of a brick.
class Brick {
 public:
  /// No label: kMaxLabels is less.
  static constexpr LabelIndex kMixed = 0xffff;
  static constexpr std::uint16_t kMostSteps = 0xffff;

  static constexpr Brick near(std::uint32_t line, LabelIndex label) {
    return Brick(line | std::uint64_t{label} << 32);
  }
  static constexpr Brick far(LabelIndex label, std::uint16_t steps) {
    return Brick(std::uint64_t{label} << 32 | std::uint64_t{steps} << 48);
  }
  constexpr explicit Brick(std::uint64_t word) : word_(word) {}

  constexpr bool is_near() const { return line() != 0; }
  /// Where its words begin, in lines of 64 bytes.
  constexpr std::uint32_t line() const { return static_cast<std::uint32_t>(word_); }
  /// Of all its voxels; kMixed where some are surface voxels.
  constexpr LabelIndex label() const { return static_cast<LabelIndex>(word_ >> 32); }
  /// Of a far brick: how far the isosurface is at least, in FeatureTransform::step_mm().
  constexpr std::uint16_t steps() const { return static_cast<std::uint16_t>(word_ >> 48); }
  constexpr std::uint64_t word() const { return word_; }

 private:
  std::uint64_t word_;
};

/// The table and the words.
class FeatureTransform {
 public:
  /// Runs on `threads` threads (0: all cores); the result is the same for any number.
  /// Throws InputError if the image has more than kMaxVoxels.
  FeatureTransform(const LabelImage& image, int threads);
  /// What the transform of an image takes while it is made, as counted in a tenth of the time.
  static std::uint64_t num_bytes(const LabelImage& image, int threads);
  /// The most that images of this size can take.
  static std::uint64_t most_bytes(const LabelImage& image);

  const BrickGrid& bricks() const { return bricks_; }
  const SurfaceTree& tree() const { return tree_; }
  /// Infinite without surface voxels.
  double step_mm() const { return step_mm_; }
  double reach_mm() const { return reach_mm_; }
  /// The table, by brick, and the lines of words, which begin at the next multiple of eight.
  std::span<const std::uint64_t> words() const { return {&words_[0], num_words_}; }

 private:
  BrickGrid bricks_;
  HugeArray<std::uint64_t> words_;
  std::size_t num_words_ = 0;
  SurfaceTree tree_;
  double step_mm_ = 0, reach_mm_ = 0;
};

/// Questions to a transform, to which it keeps a reference. `Reads` is told of each word read.
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

  /// The surface voxels near u, see SurfaceTree::visit().
  template <class Take>
  void visit(const Point& u, double& squared_reach, const Take& take) const {
    transform_->tree().visit(
        u, squared_reach,
        [&](const Voxel& at) { return surface_mask(brick(bricks_.index(at.i, at.j, at.k))); }, take);
  }
  /// The surface voxel whose centre is nearest to u, if within `reach_mm`: a search of some microseconds.
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
  /// Whether the centre of one is that near: a shorter search.
  bool is_surface_within(const Point& u, double reach_mm) const {
    constexpr double kEnd = -1;
    double squared_reach = reach_mm * reach_mm;
    visit(u, squared_reach, [&](const Voxel&, double) { squared_reach = kEnd; });
    return squared_reach == kEnd;
  }
  /// `v` lies in `brick`; none where the words do not tell.
  std::optional<Voxel> offset_to_nearest(Brick brick, const Voxel& v) const {
    if (!brick.is_near()) return std::nullopt;
    const std::uint16_t word = word_at(brick, place_in_brick(v));
    if ((word & kSurface) != 0) return Voxel{};
    const FeatureOffset offset(word);
    return offset.is_beyond() ? std::nullopt : std::optional(offset.offset());
  }
  /// The surface voxels nearest to eight voxels; none where the words do not tell all. Asks for what
  /// neighborhoods() reads of them.
  std::optional<EightVoxels> nearest(const EightVoxels& voxels) const {
    const auto bricks = voxels.bricks(bricks_), places = voxels.places_in_bricks();
    EightVoxels::Ints words;
    for (unsigned c = 0; c < EightVoxels::kNum; ++c) {
      const Brick at = brick(bricks[c]);
      if (!at.is_near()) return std::nullopt;
      const std::uint16_t word = word_at(at, places[c]);
      if (FeatureOffset(word).is_beyond()) return std::nullopt;
      words[c] = word;
    }
    const EightVoxels::Ints is_elsewhere = (words & kSurface) == 0;
    const EightVoxels features{voxels.i + (is_elsewhere & FeatureOffset::along<0>(words)),
                               voxels.j + (is_elsewhere & FeatureOffset::along<1>(words)),
                               voxels.k + (is_elsewhere & FeatureOffset::along<2>(words))};
    for (const std::uint32_t index : features.bricks(bricks_)) {
      __builtin_prefetch(bytes() + byte_of_mask(Brick(words_[index])));
    }
    return features;
  }
  /// What is around eight surface voxels.
  EightVoxels::Numbers neighborhoods(const EightVoxels& surface_voxels) const {
    const auto bricks = surface_voxels.bricks(bricks_), places = surface_voxels.places_in_bricks();
    EightVoxels::Numbers bits;
    for (unsigned c = 0; c < EightVoxels::kNum; ++c) {
      const Brick at = brick(bricks[c]);
      bits[c] = neighborhood_at(at, surface_mask(at), places[c]).bits();
    }
    return bits;
  }
  /// A lower bound of the distance from the points nearest to voxels of a far brick to the isosurface, mm.
  double distance_from_far(Brick brick) const { return brick.steps() * transform_->step_mm(); }
  /// The same between the centres of a voxel of a near brick and of a surface voxel, where the words do not
  /// tell the nearest.
  double reach_mm() const { return transform_->reach_mm(); }

  /// The label of v, which lies in `brick`, if v is a surface voxel; kUntold where words have no room for it.
  std::optional<LabelIndex> label_if_surface(Brick brick, const Voxel& v) const {
    if (brick.label() != Brick::kMixed) return std::nullopt;
    const std::uint16_t word = word_at(brick, place_in_brick(v));
    return (word & kSurface) != 0 ? std::optional<LabelIndex>(word & kUntold) : std::nullopt;
  }
  static constexpr LabelIndex kUntold = 0x7fff;

  /// A voxel off the surface has none.
  std::optional<Neighborhood> neighborhood_if_surface(const Voxel& v) const {
    const Brick brick = brick_of(v);
    if (brick.label() != Brick::kMixed) return std::nullopt;
    const std::uint64_t mask = surface_mask(brick);
    const unsigned place = place_in_brick(v);
    return (mask >> place & 1) != 0 ? std::optional(neighborhood_at(brick, mask, place)) : std::nullopt;
  }
  /// `v`, in `brick`, must be a surface voxel.
  Neighborhood neighborhood(Brick brick, const Voxel& v) const {
    return neighborhood_at(brick, surface_mask(brick), place_in_brick(v));
  }
  /// `v` must be a surface voxel.
  Neighborhood neighborhood(const Voxel& v) const { return neighborhood(brick_of(v), v); }

  /// Asks for the line of v's word; reads the table.
  void prefetch(const Voxel& v) const {
    const Brick brick(words_[bricks_.index_of_voxel(v)]);
    __builtin_prefetch(bytes() + byte_of_word(brick, place_in_brick(v)));
  }

 private:
  friend class FeatureWriter;
  static constexpr std::uint16_t kSurface = 0x8000;  // the rest is the label, or kUntold
  static constexpr std::size_t kLineBytes = 64, kBytesOfWords = 64 * sizeof(std::uint16_t);

  const std::byte* bytes() const { return reinterpret_cast<const std::byte*>(words_); }
  template <class T>
  T read(std::size_t byte) const {
    reads_.transform(byte / sizeof(std::uint64_t));
    T value;
    std::memcpy(&value, bytes() + byte, sizeof value);
    return value;
  }
  Brick brick(std::size_t index) const { return Brick(read<std::uint64_t>(index * sizeof(std::uint64_t))); }
  static std::size_t byte_of_word(Brick brick, unsigned place) {
    return brick.line() * kLineBytes + sizeof(std::uint16_t) * place;
  }
  std::uint16_t word_at(Brick brick, unsigned place) const {
    return read<std::uint16_t>(byte_of_word(brick, place));
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
