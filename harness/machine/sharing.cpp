#include "machine/sharing.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <cstdint>
#include <new>
#include <thread>
#include <vector>

#include "process/stopwatch.h"
#include "process/usable_processors.h"
#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

constexpr std::size_t kLinePairBytes = 128;  // processors fetch lines in pairs
constexpr std::size_t kPageBytes = 4096, kChunkBytes = std::size_t{64} << 10;

struct alignas(kLinePairBytes) Lines {
  std::atomic<std::uint64_t> word = 0, beside = 0;
};

struct Counts {
  int repeats = 7;
  std::uint64_t additions = 1'000'000, transfers = 200'000, pages = 4096, chunks = 1000;
};

Counts counts() {
  if (seconds_matter()) return {};
  return {.repeats = 1, .additions = 1000, .transfers = 100, .pages = 16, .chunks = 4};
}

// Pages that the process maps without huge pages, and gives back.
class Pages {
 public:
  explicit Pages(std::size_t bytes) : bytes_(bytes) {
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    madvise(memory, bytes, MADV_NOHUGEPAGE);
    data_ = static_cast<volatile char*>(memory);
  }
  ~Pages() { munmap(const_cast<char*>(data_), bytes_); }
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;

  void touch() {
    for (std::size_t i = 0; i < bytes_; i += kPageBytes) data_[i] = 1;
  }

 private:
  std::size_t bytes_;
  volatile char* data_;
};

void pin_to(int processor) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  pthread_setaffinity_np(pthread_self(), sizeof one, &one);  // a thread that is not bound still measures
}

class Sharing {
 public:
  SharingRecord measure() {
    SharingRecord record;
    record.processors = static_cast<int>(std::min<std::size_t>(2, std::max<std::size_t>(1, ids_.size())));
    measure_additions(record);
    measure_loads(record);
    measure_pages(record);
    return record;
  }

 private:
  // Calls work(thread) on both threads at the same time, and returns the seconds until both have ended.
  template <class Work>
  double seconds_of_two(const Work& work) {
    std::barrier start(2);
    std::array<double, 2> seconds{};
    const auto run = [&](std::size_t thread) {
      if (!ids_.empty()) pin_to(thread == 0 ? ids_.front() : ids_.back());
      start.arrive_and_wait();
      const Stopwatch watch;
      work(thread);
      seconds[thread] = watch.seconds();
    };
    { const std::jthread first(run, 0), second(run, 1); }
    return std::max(seconds[0], seconds[1]);
  }
  // Returns the median of the nanoseconds of one of `count` actions, all of which take measure() seconds.
  template <class Measure>
  double ns_of(std::uint64_t count, const Measure& measure) {
    std::vector<double> ns;
    for (int repeat = 0; repeat < counts_.repeats; ++repeat)
      ns.push_back(1e9 * measure() / static_cast<double>(count));
    return median(ns);
  }
  template <class Action>
  static double seconds_of(const Action& action) {
    const Stopwatch watch;
    action();
    return watch.seconds();
  }

  void add(Lines& lines) const {
    for (std::uint64_t i = 0; i < counts_.additions; ++i) lines.word.fetch_add(1, std::memory_order_relaxed);
  }

  void measure_additions(SharingRecord& record) {
    std::array<Lines, 2> lines;
    record.addition_alone_ns = ns_of(counts_.additions, [&] { return seconds_of([&] { add(lines[0]); }); });
    record.addition_separate_ns = ns_of(
        counts_.additions, [&] { return seconds_of_two([&](std::size_t thread) { add(lines[thread]); }); });
    record.addition_shared_ns =
        ns_of(2 * counts_.additions, [&] { return seconds_of_two([&](std::size_t) { add(lines[0]); }); });
    record.transfer_ns = ns_of(2 * counts_.transfers, [&] {
      std::atomic<std::uint64_t>& turn = lines[1].word;
      turn = 0;
      return seconds_of_two([&](std::size_t thread) {
        for (std::uint64_t i = thread; i < 2 * counts_.transfers; i += 2) {
          while (turn.load(std::memory_order_acquire) != i)
            if (ids_.size() < 2) std::this_thread::yield();
          turn.store(i + 1, std::memory_order_release);
        }
      });
    });
  }

  // The writer ends when the reader does.
  double seconds_of_loads(std::atomic<std::uint64_t>& read, std::atomic<std::uint64_t>& written) {
    std::atomic<bool> is_over = false;
    double seconds = 0;
    seconds_of_two([&](std::size_t thread) {
      if (thread == 1) {
        while (!is_over.load(std::memory_order_relaxed)) written.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      Lines own;
      seconds = seconds_of([&] {
        for (std::uint64_t i = 0; i < counts_.additions; ++i)
          own.word.fetch_add(read.load(std::memory_order_relaxed), std::memory_order_relaxed);
      });
      is_over = true;
    });
    return seconds;
  }

  void measure_loads(SharingRecord& record) {
    std::array<Lines, 2> lines;
    record.load_beside_writer_ns =
        ns_of(counts_.additions, [&] { return seconds_of_loads(lines[0].word, lines[0].beside); });
    record.load_apart_from_writer_ns =
        ns_of(counts_.additions, [&] { return seconds_of_loads(lines[0].word, lines[1].word); });
  }

  void measure_pages(SharingRecord& record) {
    const std::size_t bytes = counts_.pages * kPageBytes;
    record.page_fault_ns = ns_of(counts_.pages, [&] {
      Pages pages(bytes);
      return seconds_of([&] { pages.touch(); });
    });
    record.page_fault_by_each_ns = ns_of(counts_.pages, [&] {
      std::array<Pages, 2> pages{Pages(bytes), Pages(bytes)};
      return seconds_of_two([&](std::size_t thread) { pages[thread].touch(); });
    });
    Pages kept(bytes);
    kept.touch();
    record.page_touched_again_ns = ns_of(counts_.pages, [&] { return seconds_of([&] { kept.touch(); }); });
    record.mapped_chunk_ns = ns_of(counts_.chunks, [&] {
      return seconds_of([&] {
        for (std::uint64_t i = 0; i < counts_.chunks; ++i) Pages(kChunkBytes).touch();
      });
    });
    Pages recycled(kChunkBytes);
    record.recycled_chunk_ns = ns_of(counts_.chunks, [&] {
      return seconds_of([&] {
        for (std::uint64_t i = 0; i < counts_.chunks; ++i) recycled.touch();
      });
    });
  }

  const Counts counts_ = counts();
  const std::vector<int> ids_ = usable_processor_ids();
};

}  // namespace

SharingRecord measure_sharing() { return Sharing().measure(); }

}  // namespace podm::bench
