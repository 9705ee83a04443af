// Programs that count for a trial instead of the kernel: likwid-perfctr, and valgrind's cache simulation.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "options/option_keys.h"
#include "rows/row.h"

namespace podm::bench {

class CounterTool {
 public:
  virtual ~CounterTool() = default;
  /// Returns the reason why the tool cannot count here; empty: it can.
  virtual std::string absence() const = 0;
  /// True if the tool simulates the processor that the mesher runs on.
  virtual bool is_simulation() const = 0;
  /// Returns the command line that runs `command` and writes counts into `folder`.
  virtual std::vector<std::string> wrap(const std::vector<std::string>& command,
                                        const std::string& folder) const = 0;
  /// Returns counts by name. If there are none, returns the reason under the tool's name.
  virtual Counters read(const std::string& folder) const = 0;
};

/// Runs the command on a simulated processor with two levels of cache, about 50 times as slow. Threads run
/// one at a time, and the seconds have no meaning.
class Cachegrind : public CounterTool {
 public:
  std::string absence() const override;
  bool is_simulation() const override { return true; }
  std::vector<std::string> wrap(const std::vector<std::string>& command,
                                const std::string& folder) const override;
  Counters read(const std::string& folder) const override;
};

/// Counts all work of the usable processors while the command runs, including work of other processes.
class Likwid : public CounterTool {
 public:
  /// Uses the events of the file GROUP.txt for this processor, in `groups_folder`/ARCHITECTURE. Asks
  /// likwid-perfctr whether it can count them, which needs a `scratch_folder`.
  Likwid(const std::string& group, const std::string& groups_folder, const std::string& scratch_folder);

  std::string absence() const override { return absence_; }
  bool is_simulation() const override { return false; }
  std::vector<std::string> wrap(const std::vector<std::string>& command,
                                const std::string& folder) const override;
  Counters read(const std::string& folder) const override;

 private:
  std::string group_, events_, absence_;
};

/// Returns EVENT:COUNTER,... of the EVENTSET of a file in likwid's format; empty when there is none.
std::string events_of_group(const std::string& path);

/// Returns the tool that the trial's key names; null: the kernel counts.
std::unique_ptr<CounterTool> counter_tool(const std::string& choice, const std::string& groups_folder,
                                          const std::string& scratch_folder);

}  // namespace podm::bench
