#include "machine/pointer_chase.h"

#include <sys/mman.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <random>
#include <string>
#include <utility>

#include "runtime/processor_seconds.h"

namespace podm::bench {
namespace {

constexpr std::size_t kHugePageBytes = std::size_t{2} << 20;

std::size_t round_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

void* map(std::size_t bytes) {
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

// Forces the compiler to compute the value here.
template <class T>
void use(T& value) {
  asm volatile("" : "+r"(value));
}

}  // namespace

// Maps one huge page more than needed. The first line can then start at a huge page.
PointerChase::PointerChase(std::size_t bytes, std::uint64_t seed,
                           const std::function<void(void*, std::size_t)>& place)
    : mapped_bytes_(round_up(bytes, kHugePageBytes) + kHugePageBytes),
      num_lines_(std::max<std::size_t>(2, bytes / kLineBytes)),
      mapping_(map(mapped_bytes_)) {
  madvise(mapping_, mapped_bytes_, MADV_HUGEPAGE);
  try {
    if (place) place(mapping_, mapped_bytes_);
  } catch (...) {
    munmap(mapping_, mapped_bytes_);
    throw;
  }
  Line* lines = reinterpret_cast<Line*>(round_up(reinterpret_cast<std::uintptr_t>(mapping_), kHugePageBytes));
  for (std::size_t i = 0; i < num_lines_; ++i) lines[i].next = &lines[i];
  // Sattolo's shuffle gives one cycle through all lines; each such cycle is equally likely.
  std::mt19937_64 random(seed);
  for (std::size_t i = num_lines_ - 1; i > 0; --i)
    std::swap(lines[i].next, lines[std::uniform_int_distribution<std::size_t>(0, i - 1)(random)].next);
  at_ = lines;
}

PointerChase::~PointerChase() { munmap(mapping_, mapped_bytes_); }

void PointerChase::walk(std::size_t num_loads) {
  constexpr std::size_t kUnrolled = 8;
  Line* at = at_;
  for (std::size_t i = 0; i < num_loads / kUnrolled; ++i)
    at = at->next->next->next->next->next->next->next->next;
  for (std::size_t i = 0; i < num_loads % kUnrolled; ++i) at = at->next;
  use(at);
  at_ = at;
}

double PointerChase::seconds_per_load(std::size_t num_loads) {
  const double start = processor_seconds();
  walk(num_loads);
  return (processor_seconds() - start) / static_cast<double>(num_loads);
}

std::size_t PointerChase::cycle_length() {
  const Line* first = at_;
  std::size_t length = 0;
  do {
    walk(1);
    ++length;
  } while (at_ != first);
  return length;
}

// Reads the size from the part of /proc/self/smaps that contains the mapping. The kernel may have merged the
// mapping with others.
double PointerChase::huge_page_share() const {
  std::ifstream file("/proc/self/smaps");
  const auto start = reinterpret_cast<std::uintptr_t>(mapping_);
  bool is_within = false;
  for (std::string line; std::getline(file, line);) {
    if (const auto dash = line.find('-'); dash != std::string::npos && dash < line.find(' '))
      is_within =
          std::stoull(line, nullptr, 16) <= start && start < std::stoull(line.substr(dash + 1), nullptr, 16);
    const std::string key = "AnonHugePages:";
    if (is_within && line.starts_with(key)) {
      const double huge_bytes = 1024 * std::stod(line.substr(key.size()));
      return std::min(1.0,
                      huge_bytes / static_cast<double>(round_up(num_lines_ * kLineBytes, kHugePageBytes)));
    }
  }
  return 0;
}

double cycles_per_second() {
  constexpr std::size_t kAdditions = 4'000'000, kUnrolled = 8;
  std::size_t sum = 0, step = 1;
  use(step);
  const double start = processor_seconds();
  for (std::size_t i = 0; i < kAdditions / kUnrolled; ++i)
    for (std::size_t j = 0; j < kUnrolled; ++j) {
      sum += step;
      use(sum);
    }
  return static_cast<double>(kAdditions) / (processor_seconds() - start);
}

}  // namespace podm::bench
