// Counts the bytes that this program allocates.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "lines/tests/line_images.h"
#include "lines/trace_lines.h"

namespace {

std::atomic<std::size_t> bytes_in_use{0}, most_bytes_in_use{0};

void note_allocation(void* memory) {
  const std::size_t in_use = bytes_in_use += malloc_usable_size(memory);
  for (std::size_t most = most_bytes_in_use;
       most < in_use && !most_bytes_in_use.compare_exchange_weak(most, in_use);) {
  }
}

}  // namespace

void* operator new(std::size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  note_allocation(memory);
  return memory;
}
void operator delete(void* memory) noexcept {
  bytes_in_use -= malloc_usable_size(memory);
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }

namespace podm::test {
namespace {

TEST(MemoryOfLines, EstimateExceedsTheMemoryThatIsTaken) {
  Random random(11);
  std::vector<LabelImage> images;
  for (const unsigned num_labels : {3u, 5u, 60u})
    images.push_back(random_image(random, {12, 12, 12}, {1, 1, 1}, num_labels, 0.2));
  images.push_back(random_image(random, {24, 24, 20}, {1, 1, 1}, 5, 0.8));
  images.push_back(polycrystal(random, {40, 40, 40}, {1, 1, 1}, 40, false));
  for (const LabelImage& image : images)
    for (const bool is_box_flat : {false, true})
      for (const bool has_lines : {false, true}) {
        if (!is_box_flat && !has_lines) continue;
        const LineOptions options{.has_lines = has_lines, .is_box_flat = is_box_flat, .threads = 2};
        const std::size_t before = bytes_in_use;
        most_bytes_in_use = before;
        trace_lines(image, nullptr, options);
        const std::size_t taken = most_bytes_in_use - before;
        EXPECT_GE(memory_of_lines(image, options), taken) << image.labels.size() << is_box_flat << has_lines;
      }
}

}  // namespace
}  // namespace podm::test
