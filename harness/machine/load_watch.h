// How busy other work keeps the processors while a trial runs.
#pragma once

#include <iosfwd>
#include <optional>
#include <vector>

#include "rows/mesher_record.h"

namespace podm::bench {

/// Work up to a moment.
struct ProcessorUse {
  double wall_s = 0;             ///< the moment, by a clock that is never set
  std::optional<double> busy_s;  ///< processor seconds of all work on the usable processors, steal included
  double own_s = 0;              ///< those of this program and of its children that have ended
};

/// Seconds since the system's start in which these processors had work (user, nice, system, interrupts) or
/// the host took them away (steal), by the lines of /proc/stat; nothing where one of them has no line.
std::optional<double> busy_seconds(std::istream& proc_stat, const std::vector<int>& processors,
                                   double ticks_per_second);

/// Now.
ProcessorUse processor_use();

/// The mean number of usable processors that work of others kept busy in between. The kernel counts in ticks
/// of 10 ms: less than kShortestWatchS is too short to say.
Measured busy_elsewhere(const ProcessorUse& before, const ProcessorUse& after);

inline constexpr double kShortestWatchS = 0.2;

}  // namespace podm::bench
