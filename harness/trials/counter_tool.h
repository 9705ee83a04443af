// The programs that may count for a trial in the kernel's place: likwid-perfctr, and valgrind's simulation of
// caches.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "options/option_matrix.h"
#include "rows/row.h"

namespace podm::bench {

class CounterTool {
 public:
  virtual ~CounterTool() = default;
  /// Why it cannot count here; empty: it can.
  virtual std::string absence() const = 0;
  /// Whether the process is one that simulates the mesher.
  virtual bool is_simulation() const = 0;
  /// What runs the command and writes counts into `folder`.
  virtual std::vector<std::string> wrap(const std::vector<std::string>& command,
                                        const std::string& folder) const = 0;
  /// Counts by name; why there are none by the tool's name.
  virtual Counters read(const std::string& folder) const = 0;
};

/// Runs the command on a simulated processor with two levels of cache, some 50 times as slow: one thread at a
/// time, its seconds mean nothing.
class Cachegrind : public CounterTool {
 public:
  std::string absence() const override;
  bool is_simulation() const override { return true; }
  std::vector<std::string> wrap(const std::vector<std::string>& command,
                                const std::string& folder) const override;
  Counters read(const std::string& folder) const override;
};

/// Counts all that the usable processors do while the command runs, whoever does it.
class Likwid : public CounterTool {
 public:
  /// The events of the file GROUP.txt for this processor, in `groups_folder`/ARCHITECTURE. Asks
  /// likwid-perfctr whether it may count them; needs a `scratch_folder`.
  Likwid(const std::string& group, const std::string& groups_folder, const std::string& scratch_folder);

  std::string absence() const override { return absence_; }
  bool is_simulation() const override { return false; }
  std::vector<std::string> wrap(const std::vector<std::string>& command,
                                const std::string& folder) const override;
  Counters read(const std::string& folder) const override;

 private:
  std::string group_, events_, absence_;
};

/// EVENT:COUNTER,... of the EVENTSET of a file in likwid's format; empty when there is none.
std::string events_of_group(const std::string& path);

/// The tool that the trial's key asks for; null: the kernel counts.
std::unique_ptr<CounterTool> counter_tool(const std::string& choice, const std::string& groups_folder,
                                          const std::string& scratch_folder);

}  // namespace podm::bench
