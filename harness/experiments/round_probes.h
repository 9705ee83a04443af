// The machine's speed from round to round. Ratios within a round compare what ran side by side in time, so
// that a drift from one round to the next falls out of them; one within the round does not.
#pragma once

#include <optional>
#include <vector>

#include "machine/probe.h"

namespace podm::bench {

/// Probes the machine between rounds: the probe that ends one round begins the next. Whatever shares a
/// virtual processor comes and goes within seconds. A probe that is slower than the run's best one by more
/// than kToleratedMove is therefore repeated, and the best value of each kind counts: only what lasts shows.
class RoundProbes {
 public:
  /// A probe repeats at most as often, the run's first one exactly as often.
  static constexpr int kMostRepeats = 12, kFirstRepeats = 8;

  explicit RoundProbes(ProbeSource source) : source_(std::move(source)) {}

  /// Before the first trial of a round; returns the probe that its rows carry.
  Probe begin();
  /// Probes again after the last trial of the round that begin() began.
  Probe end();
  /// A round goes by that needs no probe: the next one begins with its own.
  void pass() { last_.reset(); }

 private:
  Probe settled();

  ProbeSource source_;
  std::optional<ProbeRecord> best_;  ///< of the run so far
  std::optional<Probe> last_;        ///< of the end of the round before
};

/// The speed moved during a round: two of its probes differ (probe.h). They are those of its start and end,
/// and, where the round was begun by an earlier run, those that its rows of that run carry. What is
/// unavailable does not count.
bool has_moved(const std::vector<Probe>& probes_of_round);

}  // namespace podm::bench
