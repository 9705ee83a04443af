// The error rates of the gate's answer about seconds. The gate's own rule is tried on recorded rounds and on
// a simulated machine; the answers are counted by planted slowdown.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gate/gate_rounds.h"
#include "gate/gate_slowdown.h"

namespace podm::bench {

/// The tries at one planted slowdown and their answers. One JSON line of `--json FILE`.
struct GateTries {
  std::string basis;                      ///< "measured" or "simulated"
  std::optional<std::string> clock = {};  ///< measured: "processor" or "wall", whose seconds were compared
  /// Measured: "apart", each try starts at the end of the try before; "overlapping", a try starts at each
  /// round.
  std::optional<std::string> starts = {};
  std::optional<double> noise_percent = {};  ///< simulated: of one process
  int planted_percent = 0;
  int tries = 0, slower = 0, not_slower = 0, not_resolved = 0;
  /// The 95 % interval of Clopper and Pearson for the share of answers "slower". Tries that overlap are not
  /// independent and have no interval.
  std::optional<double> slower_share_low = {}, slower_share_high = {};
  std::optional<double> median_rounds = {};         ///< rounds per try
  std::optional<double> rounds_for_an_answer = {};  ///< median over the tries that are not resolved
  static constexpr auto fields() {
    return PODM_FIELDS(GateTries, basis, (clock), (starts), (noise_percent), planted_percent, tries, slower,
                       not_slower, not_resolved, (slower_share_low), (slower_share_high), (median_rounds),
                       (rounds_for_an_answer));
  }
};

/// Returns the answers of tries on rounds in their order. Each try starts at the end of the try before; with
/// `overlapping`, one try starts at each round. A try that runs out of rounds before its answer is left out.
std::vector<Slowdown> replayed_answers(std::span<const Round> rounds, bool overlapping);

/// Tries by both clocks, both kinds of starts and each planted slowdown.
std::vector<GateTries> measured_tries(const std::vector<GateRound>& rounds);

/// Tries by noise (2, 3 and 4.5 %) and planted slowdown, `num_tries` each, on machines of different seeds.
std::vector<GateTries> simulated_tries(int num_tries);

/// Returns a table in Markdown, one line per member.
std::string table_of(const std::vector<GateTries>& tries);

}  // namespace podm::bench
