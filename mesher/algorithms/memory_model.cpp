#include "algorithms/memory_model.h"

#include <algorithm>
#include <bit>

#include "isosurface/feature_transform.h"
#include "runtime/system_memory.h"

namespace podm {

namespace {

// Scratch of operations, and the touched part of a stack.
constexpr std::uint64_t kBytesPerWorker = (5 << 15) + (1 << 16);
// Memory that the allocator holds back after lists have grown or other threads have freed it. It grows with
// the number of threads at first and then stays constant, because the threads' lists become shorter. Measured
// for 1 to 224 threads.
constexpr std::uint64_t kBytesHeldPerThread = 3 << 18, kMostThreadsThatHold = 16;
constexpr std::uint64_t kLeastCells = 1 << 12;
static_assert(4 * kMostStoredCells - 1 < kNoFacet);

}  // namespace

std::uint64_t bytes_of_threads(std::uint64_t threads) {
  return threads * kBytesPerWorker + std::min(threads, kMostThreadsThatHold) * kBytesHeldPerThread;
}

std::uint64_t bytes_of_bricks(const ImageByBricks& image, int num_ranks) {
  const std::vector<LabelIndex>& labels = image.label_of_brick;
  const auto num_mixed = static_cast<double>(std::count(labels.begin(), labels.end(), ImageByBricks::kMixed));
  const auto num_bricks = static_cast<double>(labels.size());
  const double read = std::min(1.0, kSharesOfRank / num_ranks + kPagesOfSeeds * kBricksPerPage / num_bricks);
  return static_cast<std::uint64_t>(kBytesPerBrick * num_bricks + kBytesPerMixedBrick * num_mixed * read);
}

std::uint64_t transform_bytes(const LabelImage& image, std::uint64_t limit_bytes, int threads,
                              int num_ranks) {
  constexpr std::uint64_t kLittle = 32;  // 1 / kLittle of the limit need not be known exactly
  if (const ImageByBricks* in_file = by_bricks(image)) return bytes_of_bricks(*in_file, num_ranks);
  const std::uint64_t most = FeatureTransform::most_bytes(image);
  return most <= limit_bytes / kLittle ? most : FeatureTransform::num_bytes(image, threads);
}

std::uint64_t memory_of_run(const Limits& limits) {
  return limits.max_memory_bytes > 0 ? limits.max_memory_bytes : physical_memory_bytes();
}

std::uint64_t cell_capacity(std::uint64_t bytes, std::uint64_t num_workers, Executor executor, bool has_log) {
  const std::uint64_t of_workers =
      executor == Executor::kVirtual ? num_workers * kBytesPerWorker : bytes_of_threads(num_workers);
  const std::uint64_t bytes_per_cell = kBytesPerStoredCell + (has_log ? kStampBytesPerStoredCell : 0);
  const auto fits = [&](std::uint64_t cells) {
    return of_workers + PoorElementList::stale_bytes(cells, num_workers) + cells * bytes_per_cell <= bytes;
  };
  std::uint64_t cells = kLeastCells;
  for (std::uint64_t step = std::bit_floor(kMostStoredCells); step > 0; step /= 2)
    if (cells + step <= kMostStoredCells && fits(cells + step)) cells += step;
  return cells;
}

}  // namespace podm
