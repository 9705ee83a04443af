#include "isosurface/feature_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "isosurface/feature_transform.h"

namespace podm {

// The relative error of squares and roots is smaller.
constexpr double kRoundedDown = 1 - 1e-12;

FeatureWriter::FeatureWriter(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                             const Surroundings& surroundings)
    : image_(image),
      in_file_(by_bricks(image)),
      bricks_(bricks),
      masks_(masks),
      surroundings_(surroundings),
      features_(image, bricks, masks, surroundings),
      row_(static_cast<std::size_t>(bricks.size()[0])) {
  using Words = Features<NoReads>;
  static_assert(LayoutOfBrick::kWordsOfLine * sizeof(std::uint64_t) == Words::kLineBytes &&
                LayoutOfBrick::kMaskAt * sizeof(std::uint64_t) == Words::kBytesOfWords);
}

std::vector<FeatureWriter::Scratch> FeatureWriter::scratch_for(std::size_t threads) const {
  const std::size_t most_around = row_ + 2 * static_cast<std::size_t>(Surroundings::kMostBricks);
  return std::vector<Scratch>(threads,
                              {std::vector<std::uint64_t>(most_around), std::vector<std::uint64_t>(row_)});
}

std::size_t FeatureWriter::count_lines(std::size_t row, Scratch& scratch) const {
  const std::vector<std::uint64_t>& around = surface_around(row, surroundings_.num_bricks(), scratch);
  std::size_t lines = 0;
  for (std::size_t i = 0; i < row_; ++i)
    if (around[i] != 0) lines += LayoutOfBrick::lines_of(masks_[row * row_ + i]);
  return lines;
}

void FeatureWriter::mark_beside_surface(std::size_t row, HugeArray<std::uint64_t>& words,
                                        Scratch& scratch) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::uint64_t>& beside = surface_around(row, {1, 1, 1}, scratch);
  for (std::size_t i = 0; i < row_; ++i)
    words[row * row_ + i] = std::bit_cast<std::uint64_t>(beside[i] != 0 ? 0.0 : kInfinity);
}

void FeatureWriter::write(std::size_t row, std::size_t line, double step_mm, HugeArray<std::uint64_t>& words,
                          Scratch& scratch) const {
  const std::vector<std::uint64_t>& around = surface_around(row, surroundings_.num_bricks(), scratch);
  for (std::size_t i = 0; i < row_; ++i) {
    const Voxel brick = at(row, static_cast<int>(i));
    const std::uint64_t mask = masks_[row * row_ + i];
    std::uint64_t& word = words[row * row_ + i];
    const LabelIndex label = label_of(row * row_ + i, brick);
    if (around[i] == 0) {
      const double steps = std::sqrt(std::bit_cast<double>(word)) * kRoundedDown / step_mm;
      word =
          Brick::far(label, steps < Brick::kMostSteps ? static_cast<std::uint16_t>(steps) : Brick::kMostSteps)
              .word();
    } else if (in_file_ != nullptr) {
      word = Brick::unread(label).word();
    } else {
      word = Brick::near(static_cast<std::uint32_t>(line), label).word();
      write_words(brick, mask, &words[line * LayoutOfBrick::kWordsOfLine]);
      line += LayoutOfBrick::lines_of(mask);
    }
  }
}

LabelIndex FeatureWriter::label_of(std::size_t index, const Voxel& brick) const {
  if (masks_[index] != 0) return Brick::kMixed;
  return in_file_ != nullptr ? in_file_->label_of_brick[index]
                             : image_.voxels[image_.index(4 * brick.i, 4 * brick.j, 4 * brick.k)];
}

Voxel FeatureWriter::at(std::size_t row, int i) const {
  const auto rows = static_cast<std::size_t>(bricks_.size()[1]);
  return {i, static_cast<int>(row % rows), static_cast<int>(row / rows)};
}

// Nonzero for each brick of a row that has surface voxels within `num_bricks` bricks on each side.
const std::vector<std::uint64_t>& FeatureWriter::surface_around(std::size_t row,
                                                                const std::array<int, 3>& num_bricks,
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

void FeatureWriter::write_words(const Voxel& brick, std::uint64_t mask, std::uint64_t* to) const {
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
    to[LayoutOfBrick::kMaskAt] = mask;
    std::memcpy(to + LayoutOfBrick::kMaskAt + 1, bits.data(), count * sizeof bits[0]);
  }
  std::memcpy(to, of_voxels.data(), sizeof of_voxels);
}

}  // namespace podm
