#include "machine/load_watch.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "machine/machine.h"
#include "process/usable_processors.h"

namespace podm::bench {
namespace {

// Returns the ticks of one line of /proc/stat: "cpu0 user nice system idle iowait irq softirq steal guest
// guest_nice". Guest ticks are already included in user and nice.
double busy_ticks(std::istringstream& fields) {
  double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
  fields >> user >> nice >> system >> idle >> iowait >> irq >> softirq >> steal;
  return user + nice + system + irq + softirq + steal;
}

double seconds_of(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

std::optional<double> busy_seconds(std::istream& proc_stat, const std::vector<int>& processors,
                                   double ticks_per_second) {
  std::set<std::string> awaited;
  for (const int processor : processors) awaited.insert(fmt::format("cpu{}", processor));
  if (awaited.empty()) awaited.insert("cpu");  // the line of all processors
  double ticks = 0;
  for (std::string line; !awaited.empty() && std::getline(proc_stat, line);) {
    std::istringstream fields(line);
    std::string name;
    fields >> name;
    if (awaited.erase(name) > 0) ticks += busy_ticks(fields);
  }
  if (!awaited.empty()) return {};
  return ticks / ticks_per_second;
}

ProcessorUse processor_use() {
  std::ifstream proc_stat("/proc/stat");
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(now).count(),
          busy_seconds(proc_stat, usable_processor_ids(), static_cast<double>(sysconf(_SC_CLK_TCK))),
          seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN)};
}

Measured busy_elsewhere(const ProcessorUse& before, const ProcessorUse& after) {
  if (!before.busy_s || !after.busy_s) return Unavailable{"/proc/stat does not list the usable processors"};
  const double wall_s = after.wall_s - before.wall_s, own_s = after.own_s - before.own_s;
  if (wall_s < kShortestWatchS)
    return Unavailable{fmt::format("the trial took less than {} s", kShortestWatchS)};
  const double busy_s = *after.busy_s - *before.busy_s;
  // Some sandboxes list processors that are always idle.
  if (busy_s < 0.5 * own_s) return Unavailable{"/proc/stat does not count the trial's own work"};
  return std::max(0.0, busy_s - own_s) / wall_s;
}

}  // namespace podm::bench
