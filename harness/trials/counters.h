// Counts of a trial's process by perf_event_open(2), or why there are none.
#pragma once

#include <linux/perf_event.h>

#include <functional>
#include <vector>

#include "process/process.h"
#include "rows/row.h"

namespace podm::bench {

/// Opens a counter of the calling thread and of the children it starts later: a descriptor, or minus the
/// error.
using OpenCounter = std::function<int(perf_event_attr&)>;
/// The kernel's.
int open_counter(perf_event_attr& attributes);

enum class CounterKinds {
  kSoftware,             ///< kept by the kernel
  kSoftwareAndHardware,  ///< and by the processor
};

/// The first counter on a machine makes the kernel patch its scheduler, some 10 ms, and the last one undoes
/// that. One of these, which counts nothing, spares each trial the wait.
class CountersKeptReady {
 public:
  CountersKeptReady();
  ~CountersKeptReady();
  CountersKeptReady(const CountersKeptReady&) = delete;
  CountersKeptReady& operator=(const CountersKeptReady&) = delete;

 private:
  int descriptor_;
};

/// Counts the programs that this thread starts, with their threads and children, while the object lives.
class PerfCounters {
 public:
  explicit PerfCounters(CounterKinds kinds, const OpenCounter& open = open_counter);
  ~PerfCounters();
  PerfCounters(const PerfCounters&) = delete;
  PerfCounters& operator=(const PerfCounters&) = delete;

  /// Counts by name of the process that has ended with `outcome`.
  Counters read(const ProcessOutcome& outcome) const;

 private:
  struct OpenedCounter {
    int descriptor;  // or minus the error
    bool is_of_user_mode;
  };
  std::vector<OpenedCounter> counters_;  // their order is that of the table of events
};

}  // namespace podm::bench
