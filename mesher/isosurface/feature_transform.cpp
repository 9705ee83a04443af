#include "isosurface/feature_transform.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "image/image_by_bricks.h"
#include "isosurface/brick_distances.h"
#include "isosurface/feature_writer.h"
#include "isosurface/surface_masks.h"
#include "isosurface/unread_bricks.h"
#include "podm/errors.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

using Layout = LayoutOfBrick;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const LabelImage& checked(const LabelImage& image) {
  const bool holds_voxels = by_bricks(image) == nullptr;
  const std::size_t number = holds_voxels ? image.num_voxels() : BrickGrid(image.size).count(),
                    most = holds_voxels ? kMaxVoxels : kMaxBricks;
  if (number <= most) return image;
  throw InputError("image: " + std::to_string(number) +
                   (holds_voxels ? " voxels" : " bricks of 4 x 4 x 4 voxels") +
                   "; the feature transform takes at most " + std::to_string(most));
}

// The bytes of the table, the masks and this number of lines of words.
std::uint64_t bytes_of(const BrickGrid& bricks, std::size_t lines) {
  return sizeof(std::uint64_t) * (2 * (bricks.count() + Layout::kWordsOfLine) + lines * Layout::kWordsOfLine);
}

// The lines of words that a transform may need, fewer than an entry can number.
std::size_t most_lines(const LabelImage& image, const BrickGrid& bricks) {
  constexpr std::size_t kMostNumber = 0xfffffffe, kLinesOfLabels = 2;
  const std::size_t of_brick = Layout::kMostLines + (by_bricks(image) != nullptr ? kLinesOfLabels : 0);
  return std::min(kMostNumber, Layout::in_lines(bricks.count()) + of_brick * bricks.count());
}

void mark(const LabelImage& image, const BrickGrid& bricks, std::size_t threads, SurfaceMasks& masks) {
  const ImageByBricks* in_file = by_bricks(image);
  if (in_file == nullptr) return mark_surface(image, bricks, threads, masks);
  const std::vector<LabelIndex>& labels = in_file->label_of_brick;
  for (std::size_t b = 0; b < labels.size(); ++b) masks[b] = labels[b] == ImageByBricks::kMixed;
}

}  // namespace

FeatureTransform::FeatureTransform(const LabelImage& image, int threads)
    : bricks_(checked(image).size), words_(Layout::kWordsOfLine * most_lines(image, bricks_)) {
  const std::size_t num_bricks = bricks_.count(), used = num_threads(threads);
  SurfaceMasks masks(num_bricks);
  mark(image, bricks_, used, masks);
  tree_ = SurfaceTree(bricks_, {&masks[0], num_bricks}, image.spacing);

  const Surroundings surroundings(image);
  reach_mm_ = surroundings.reach_mm();
  const FeatureWriter writer(image, bricks_, masks, surroundings);
  std::vector<FeatureWriter::Scratch> scratch = writer.scratch_for(used);
  std::vector<std::size_t> line_of_row(writer.num_rows() + 1, 0);
  parallel_for(writer.num_rows(), used, [&](std::size_t row, std::size_t thread) {
    if (by_bricks(image) == nullptr) line_of_row[row + 1] = writer.count_lines(row, scratch[thread]);
    writer.mark_beside_surface(row, words_, scratch[thread]);
  });
  line_of_row[0] = Layout::in_lines(num_bricks);
  for (std::size_t row = 0; row < writer.num_rows(); ++row) line_of_row[row + 1] += line_of_row[row];
  num_words_ = line_of_row.back() * Layout::kWordsOfLine;

  const auto& [x, y, z] = image.spacing;
  const auto& [nx, ny, nz] = bricks_.size();
  step_mm_ = tree_.is_empty() ? kInfinity : 4 * std::hypot(x * nx, y * ny, z * nz) / (Brick::kMostSteps - 1);
  find_squared_distances(bricks_, {4 * x, 4 * y, 4 * z}, used, {&words_[0], num_bricks});
  parallel_for(writer.num_rows(), used, [&](std::size_t row, std::size_t thread) {
    writer.write(row, line_of_row[row], step_mm_, words_, scratch[thread]);
  });
  if (const ImageByBricks* in_file = by_bricks(image))
    unread_ = std::make_unique<UnreadBricks>(*in_file, bricks_, line_of_row.back(), words_);
}

FeatureTransform::~FeatureTransform() = default;

Brick FeatureTransform::read_brick(std::size_t index) const { return unread_->read(index); }

std::uint64_t FeatureTransform::bytes_read() const { return unread_ != nullptr ? unread_->bytes_read() : 0; }

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
  return bytes_of(bricks, Layout::kMostLines * bricks.count());
}

}  // namespace podm
