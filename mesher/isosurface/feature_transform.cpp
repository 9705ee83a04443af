#include "isosurface/feature_transform.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "isosurface/brick_distances.h"
#include "isosurface/surface_masks.h"
#include "podm/errors.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr std::size_t kWordsOfLine = 8;
// The layout of a near brick in words of 8 bytes: first the words of its voxels, then the mask of surface
// voxels and their neighborhoods.
constexpr std::size_t kMaskAt = 16, kMostLines = 7;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The relative error of squares and roots is smaller.
constexpr double kRoundedDown = 1 - 1e-12;

std::size_t in_lines(std::size_t words) { return (words + kWordsOfLine - 1) / kWordsOfLine; }

const LabelImage& checked(const LabelImage& image) {
  if (image.num_voxels() > kMaxVoxels) {
    throw InputError("image: " + std::to_string(image.num_voxels()) +
                     " voxels; the feature transform takes at most " + std::to_string(kMaxVoxels));
  }
  return image;
}

std::size_t lines_of(std::uint64_t mask) {
  const auto num_surface = static_cast<std::size_t>(std::popcount(mask));
  return in_lines(num_surface == 0 ? kMaskAt : kMaskAt + 1 + (num_surface + 1) / 2);
}

// The bytes of the table, the masks and this number of lines of words.
std::uint64_t bytes_of(const BrickGrid& bricks, std::size_t lines) {
  return sizeof(std::uint64_t) * (2 * (bricks.count() + kWordsOfLine) + lines * kWordsOfLine);
}

}  // namespace

// Makes the table and the words, one row of bricks at a time.
class FeatureWriter {
 public:
  using Layout = Features<NoReads>;
  static_assert(kWordsOfLine * sizeof(std::uint64_t) == Layout::kLineBytes &&
                kMaskAt * sizeof(std::uint64_t) == Layout::kBytesOfWords);
  /// One thread's scratch memory, by brick of a row.
  struct Scratch {
    std::vector<std::uint64_t> any, around;
  };

  FeatureWriter(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                const Surroundings& surroundings)
      : image_(image),
        bricks_(bricks),
        masks_(masks),
        surroundings_(surroundings),
        features_(image, bricks, masks, surroundings),
        row_(static_cast<std::size_t>(bricks.size()[0])) {}

  std::size_t num_rows() const { return bricks_.count() / row_; }
  std::vector<Scratch> scratch_for(std::size_t threads) const {
    const std::size_t most_around = row_ + 2 * static_cast<std::size_t>(Surroundings::kMostBricks);
    return std::vector<Scratch>(threads,
                                {std::vector<std::uint64_t>(most_around), std::vector<std::uint64_t>(row_)});
  }

  std::size_t count_lines(std::size_t row, Scratch& scratch) const {
    const std::vector<std::uint64_t>& around = surface_around(row, surroundings_.num_bricks(), scratch);
    std::size_t lines = 0;
    for (std::size_t i = 0; i < row_; ++i)
      if (around[i] != 0) lines += lines_of(masks_[row * row_ + i]);
    return lines;
  }

  // Writes into the table, as doubles, 0 for bricks with surface voxels and their neighbors, and infinity for
  // all other bricks.
  void mark_beside_surface(std::size_t row, HugeArray<std::uint64_t>& words, Scratch& scratch) const {
    const std::vector<std::uint64_t>& beside = surface_around(row, {1, 1, 1}, scratch);
    for (std::size_t i = 0; i < row_; ++i)
      words[row * row_ + i] = std::bit_cast<std::uint64_t>(beside[i] != 0 ? 0.0 : kInfinity);
  }

  // Replaces the squared distances in the table by its final entries. The words of this row's bricks begin at
  // `line`.
  void write(std::size_t row, std::size_t line, double step_mm, HugeArray<std::uint64_t>& words,
             Scratch& scratch) const {
    const std::vector<std::uint64_t>& around = surface_around(row, surroundings_.num_bricks(), scratch);
    for (std::size_t i = 0; i < row_; ++i) {
      const Voxel brick = at(row, static_cast<int>(i));
      const std::uint64_t mask = masks_[row * row_ + i];
      std::uint64_t& word = words[row * row_ + i];
      const LabelIndex label =
          mask != 0 ? Brick::kMixed : image_.voxels[image_.index(4 * brick.i, 4 * brick.j, 4 * brick.k)];
      if (around[i] == 0) {
        const double steps = std::sqrt(std::bit_cast<double>(word)) * kRoundedDown / step_mm;
        word = Brick::far(label,
                          steps < Brick::kMostSteps ? static_cast<std::uint16_t>(steps) : Brick::kMostSteps)
                   .word();
      } else {
        word = Brick::near(static_cast<std::uint32_t>(line), label).word();
        write_words(brick, mask, &words[line * kWordsOfLine]);
        line += lines_of(mask);
      }
    }
  }

 private:
  Voxel at(std::size_t row, int i) const {
    const auto rows = static_cast<std::size_t>(bricks_.size()[1]);
    return {i, static_cast<int>(row % rows), static_cast<int>(row / rows)};
  }

  // Nonzero for each brick of a row that has surface voxels within `num_bricks` bricks on each side.
  const std::vector<std::uint64_t>& surface_around(std::size_t row, const std::array<int, 3>& num_bricks,
                                                   Scratch& scratch) const {
    const auto [x, y, z] = num_bricks;
    const Voxel first = at(row, 0);
    auto& [any, around] = scratch;
    std::fill(any.begin(), any.end(), 0);
    std::fill(around.begin(), around.end(), 0);
    for (int k = std::max(0, first.k - z); k <= std::min(bricks_.size()[2] - 1, first.k + z); ++k)
      for (int j = std::max(0, first.j - y); j <= std::min(bricks_.size()[1] - 1, first.j + y); ++j) {
        const std::uint64_t* const masks = &masks_[bricks_.index(0, j, k)];
        for (std::size_t i = 0; i < row_; ++i) any[i + static_cast<std::size_t>(x)] |= masks[i];
      }
    for (std::size_t d = 0; d <= 2 * static_cast<std::size_t>(x); ++d)
      for (std::size_t i = 0; i < row_; ++i) around[i] |= any[i + d];
    return around;
  }

  void write_words(const Voxel& brick, std::uint64_t mask, std::uint64_t* to) const {
    const std::array<FeatureOffset, 64> offsets = features_.offsets(brick);
    std::array<std::uint16_t, 64> of_voxels;
    for (std::size_t p = 0; p < 64; ++p) of_voxels[p] = offsets[p].bits();
    if (mask != 0) {
      const BrickNeighborhoods neighborhoods(image_, brick);
      std::array<std::uint32_t, 64> bits;
      std::size_t count = 0;
      for (std::uint64_t rest = mask; rest != 0; rest &= rest - 1) {
        const auto p = static_cast<unsigned>(std::countr_zero(rest));
        const Neighborhood around = neighborhoods.around(p);
        bits[count++] = around.bits();
        of_voxels[p] = StoredFeature::word_of_surface(around, neighborhoods.label(p));
      }
      to[kMaskAt] = mask;
      std::memcpy(to + kMaskAt + 1, bits.data(), count * sizeof bits[0]);
    }
    std::memcpy(to, of_voxels.data(), sizeof of_voxels);
  }

  const LabelImage& image_;
  const BrickGrid& bricks_;
  const SurfaceMasks& masks_;
  const Surroundings& surroundings_;
  BrickFeatures features_;
  std::size_t row_;  // bricks
};

FeatureTransform::FeatureTransform(const LabelImage& image, int threads)
    : bricks_(checked(image).size),
      words_(kWordsOfLine * (in_lines(bricks_.count()) + kMostLines * bricks_.count())) {
  const std::size_t num_bricks = bricks_.count(), used = num_threads(threads);
  SurfaceMasks masks(num_bricks);
  mark_surface(image, bricks_, used, masks);
  tree_ = SurfaceTree(bricks_, {&masks[0], num_bricks}, image.spacing);

  const Surroundings surroundings(image);
  reach_mm_ = surroundings.reach_mm();
  const FeatureWriter writer(image, bricks_, masks, surroundings);
  std::vector<FeatureWriter::Scratch> scratch = writer.scratch_for(used);
  std::vector<std::size_t> line_of_row(writer.num_rows() + 1, 0);
  parallel_for(writer.num_rows(), used, [&](std::size_t row, std::size_t thread) {
    line_of_row[row + 1] = writer.count_lines(row, scratch[thread]);
    writer.mark_beside_surface(row, words_, scratch[thread]);
  });
  line_of_row[0] = in_lines(num_bricks);
  for (std::size_t row = 0; row < writer.num_rows(); ++row) line_of_row[row + 1] += line_of_row[row];
  num_words_ = line_of_row.back() * kWordsOfLine;

  const auto& [x, y, z] = image.spacing;
  const auto& [nx, ny, nz] = bricks_.size();
  step_mm_ = tree_.is_empty() ? kInfinity : 4 * std::hypot(x * nx, y * ny, z * nz) / (Brick::kMostSteps - 1);
  find_squared_distances(bricks_, {4 * x, 4 * y, 4 * z}, used, {&words_[0], num_bricks});
  parallel_for(writer.num_rows(), used, [&](std::size_t row, std::size_t thread) {
    writer.write(row, line_of_row[row], step_mm_, words_, scratch[thread]);
  });
}

std::uint64_t FeatureTransform::num_bytes(const LabelImage& image, int threads) {
  const BrickGrid bricks(checked(image).size);
  const std::size_t used = num_threads(threads);
  SurfaceMasks masks(bricks.count());
  mark_surface(image, bricks, used, masks);
  const Surroundings surroundings(image);
  const FeatureWriter writer(image, bricks, masks, surroundings);
  std::vector<FeatureWriter::Scratch> scratch = writer.scratch_for(used);
  std::atomic<std::size_t> lines{0};
  parallel_for(writer.num_rows(), used, [&](std::size_t row, std::size_t thread) {
    lines += writer.count_lines(row, scratch[thread]);
  });
  return bytes_of(bricks, lines);
}

std::uint64_t FeatureTransform::most_bytes(const LabelImage& image) {
  const BrickGrid bricks(image.size);
  return bytes_of(bricks, kMostLines * bricks.count());
}

}  // namespace podm
