#include "gate/gate_slowdown.h"

#include <cmath>
#include <vector>

namespace podm::bench {

double Slowdown::rounds_for_an_answer() const {
  const double too_wide = (ratio.high - ratio.low) / (kSevere - kNoticeable);
  return std::ceil(num_rounds * too_wide * too_wide);
}

// Only seconds of one round are divided by each other: the machine's speed changes more between rounds than a
// program's speed may.
CentreEstimate head_over_base(std::span<const Round> rounds) {
  constexpr double kConfidenceOfLook = 1 - (1 - kConfidenceOfLooks) / kLooks.size();
  std::vector<double> logarithms;
  logarithms.reserve(rounds.size());
  for (const Round& round : rounds) logarithms.push_back(std::log(round.head_s / round.base_s));
  const CentreEstimate centre = signed_rank_estimate(logarithms, kConfidenceOfLook);
  return {std::exp(centre.value), std::exp(centre.low), std::exp(centre.high)};
}

std::optional<Slowdown> measure_slowdown(const std::function<std::optional<Round>()>& next_round) {
  std::vector<Round> rounds;
  Slowdown slowdown;
  for (const int num_rounds : kLooks) {
    while (static_cast<int>(rounds.size()) < num_rounds) {
      const std::optional<Round> round = next_round();
      if (!round) return {};
      rounds.push_back(*round);
    }
    slowdown = {.ratio = head_over_base(rounds), .num_rounds = num_rounds};
    if (slowdown.ratio.low > kNoticeable)
      slowdown.answer = Answer::kSlower;
    else if (slowdown.ratio.high < kSevere)
      slowdown.answer = Answer::kNotSlower;
    if (slowdown.answer != Answer::kNotResolved) break;
  }
  return slowdown;
}

}  // namespace podm::bench
