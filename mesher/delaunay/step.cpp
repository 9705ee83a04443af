#include "delaunay/step.h"

#include <atomic>
#include <cstdint>
#include <random>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>

#include "podm/errors.h"
#include "runtime/fibre.h"

namespace podm {

namespace {

// An operation has on the order of a hundred steps: about one thread in two yields in its middle.
constexpr std::uint64_t kStepsToYield = 256;

// The cells that attempts of fibres rely on. Reads of threads without fibres are not recorded.
using Reads = std::unordered_map<const Fibre*, std::unordered_set<std::uint32_t>>;
thread_local Reads reads_of_fibres;

// Each thread has its own seed. Relaxed: an order between threads would hide their races from the thread
// sanitizer.
std::uint32_t next_seed() {
  static std::atomic<std::uint32_t> seed = 1;
  return seed.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

void step() {
  if (Fibre* const fibre = Fibre::current()) return fibre->step();
  thread_local std::minstd_rand random(next_seed());
  if (random() % kStepsToYield == 0) std::this_thread::yield();
}

void note_read(std::uint32_t cell) {
  step();
  const Fibre* const self = Fibre::current();
  if (self != nullptr && self->is_limited())
    reads_of_fibres[self].insert(cell);  // an attempt, not another use of the store
}

void forget_reads() {
  if (const Fibre* const self = Fibre::current()) reads_of_fibres.erase(self);
}

void note_replaced(std::uint32_t cell) {
  const Fibre* const self = Fibre::current();
  for (const auto& [other, cells] : reads_of_fibres) {
    if (other == self || !cells.contains(cell)) continue;
    reads_of_fibres.clear();  // the run ends here
    throw InternalError("cell " + std::to_string(cell) + " is replaced while another worker reads it");
  }
}

}  // namespace podm
