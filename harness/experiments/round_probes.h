// Monitors the machine's speed from round to round. Ratios within a round compare runs that are close in
// time. A drift from one round to the next cancels in them; a drift within the round does not.
#pragma once

#include <optional>
#include <vector>

#include "machine/probe.h"

namespace podm::bench {

/// Probes the machine between rounds. The probe that ends one round begins the next. Other users of a virtual
/// processor come and go within seconds. A probe that is slower than the run's best one by more than
/// kToleratedMove is therefore repeated, and the best value of each kind counts. Only lasting changes show.
class RoundProbes {
 public:
  /// Maximum number of measurements of a probe, and the number for the run's first one.
  static constexpr int kMostRepeats = 6, kFirstRepeats = 8;

  /// Without `repeats` each probe is measured once.
  explicit RoundProbes(ProbeSource source, bool repeats = true)
      : source_(std::move(source)), repeats_(repeats) {}

  /// Call before the first trial of a round. Returns the probe that its rows record.
  Probe begin();
  /// Probes again after the last trial of the round that begin() began.
  Probe end();
  /// Passes a round that needs no probe. The next round begins with a probe of its own.
  void pass() { last_.reset(); }

 private:
  Probe settled();

  ProbeSource source_;
  bool repeats_;
  std::optional<ProbeRecord> best_;  ///< of the run so far
  std::optional<Probe> last_;        ///< of the end of the round before
};

/// True if the speed moved during a round: two of its probes differ (probe.h). The probes are those of the
/// start and the end of the round, and, if an earlier run began the round, those in its rows of that run.
/// Unavailable probes do not count.
bool has_moved(const std::vector<Probe>& probes_of_round);

}  // namespace podm::bench
