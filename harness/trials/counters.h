// Counts of a trial's process by perf_event_open(2), or the reason why there are none.
#pragma once

#include <linux/perf_event.h>

#include <functional>
#include <vector>

#include "process/process.h"
#include "rows/row.h"

namespace podm::bench {

/// Opens a counter of the calling thread and of the children that it starts later. Returns a descriptor, or
/// the negative error.
using OpenCounter = std::function<int(perf_event_attr&)>;
/// Opens a counter of the kernel.
int open_counter(perf_event_attr& attributes);

enum class CounterKinds {
  kSoftware,             ///< the kernel's counts
  kSoftwareAndHardware,  ///< and the processor's counts
};

/// The first counter on a machine makes the kernel patch its scheduler, which takes about 10 ms, and closing
/// the last one reverts the patch. An object of this class keeps a counter that counts nothing and spares
/// each trial the wait.
class CountersKeptReady {
 public:
  CountersKeptReady();
  ~CountersKeptReady();
  CountersKeptReady(const CountersKeptReady&) = delete;
  CountersKeptReady& operator=(const CountersKeptReady&) = delete;

 private:
  int descriptor_;
};

/// Counts the programs that this thread starts, with their threads and children, during the life of the
/// object.
class PerfCounters {
 public:
  explicit PerfCounters(CounterKinds kinds, const OpenCounter& open = open_counter);
  ~PerfCounters();
  PerfCounters(const PerfCounters&) = delete;
  PerfCounters& operator=(const PerfCounters&) = delete;

  /// Returns counts by name for the process that has ended with `outcome`.
  Counters read(const ProcessOutcome& outcome) const;

 private:
  struct OpenedCounter {
    int descriptor;  // or the negative error
    bool is_of_user_mode;
  };
  std::vector<OpenedCounter> counters_;  // in the order of the table of events
};

}  // namespace podm::bench
