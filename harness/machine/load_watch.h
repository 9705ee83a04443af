// Measures the load that other work puts on the processors during a trial.
#pragma once

#include <iosfwd>
#include <optional>
#include <vector>

#include "rows/mesher_record.h"

namespace podm::bench {

/// Processor use up to a moment.
struct ProcessorUse {
  double wall_s = 0;             ///< the moment, by a monotonic clock
  std::optional<double> busy_s;  ///< processor seconds of all work on the usable processors, including steal
  double own_s = 0;              ///< processor seconds of this program and of its children that have ended
};

/// Returns the seconds since the system's start in which these processors had work (user, nice, system,
/// interrupts) or were taken away by the host (steal), by the lines of /proc/stat. Returns nothing if a
/// processor has no line.
std::optional<double> busy_seconds(std::istream& proc_stat, const std::vector<int>& processors,
                                   double ticks_per_second);

/// Returns the current processor use.
ProcessorUse processor_use();

/// Returns the mean number of usable processors that other work kept busy between the two moments. The kernel
/// counts in ticks of 10 ms, therefore an interval shorter than kShortestWatchS gives no result.
Measured busy_elsewhere(const ProcessorUse& before, const ProcessorUse& after);

inline constexpr double kShortestWatchS = 0.2;

}  // namespace podm::bench
