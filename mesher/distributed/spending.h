// The seconds that a rank spends in each phase.
#pragma once

#include <map>
#include <string>

#include "distributed/communication.h"

namespace podm {

/// Seconds of one phase.
struct PhaseSeconds {
  double computing_s = 0, waiting_s = 0, network_s = 0;

  PhaseSeconds& operator+=(const PhaseSeconds& b) {
    computing_s += b.computing_s;
    waiting_s += b.waiting_s;
    network_s += b.network_s;
    return *this;
  }
  PhaseSeconds& operator-=(const PhaseSeconds& b) {
    return *this += {-b.computing_s, -b.waiting_s, -b.network_s};
  }
};
using SpentByPhase = std::map<std::string, PhaseSeconds>;

class Spending {
 public:
  explicit Spending(const Communication& ranks) : ranks_(ranks), last_(ranks.report()) {}

  /// Assigns the time since the last call, or since construction, to this phase.
  void end(const std::string& phase) {
    const RankReport now = ranks_.report();
    by_phase_[phase] += {now.computing_s - last_.computing_s, now.waiting_s - last_.waiting_s,
                         now.network_s - last_.network_s};
    last_ = now;
  }
  /// Adds the given times per phase, reported from outside, in place of the time since the last call.
  void end(const SpentByPhase& phases) {
    for (const auto& [phase, spent] : phases) by_phase_[phase] += spent;
    last_ = ranks_.report();
  }
  /// Takes these times away from their phases and gives them to another phase.
  void reassign(const SpentByPhase& phases, const std::string& to) {
    for (const auto& [phase, spent] : phases) {
      by_phase_[phase] -= spent;
      by_phase_[to] += spent;
    }
  }
  const SpentByPhase& by_phase() const { return by_phase_; }

 private:
  const Communication& ranks_;
  RankReport last_;
  SpentByPhase by_phase_;
};

}  // namespace podm
