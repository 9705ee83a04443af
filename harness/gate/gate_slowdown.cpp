#include "gate/gate_slowdown.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace podm::bench {
namespace {

// Stricter than an interval that is looked at once: a gate looks up to eight times.
constexpr BootstrapOptions kBootstrap{.confidence = 0.998, .num_resamples = 1000};

// The machine's speed changes between rounds more than a program may: each round's seconds are taken relative
// to the base's in that round, so the medians compared are those of ratios.
Slowdown judge(const std::vector<Round>& rounds) {
  std::vector<double> head, again;
  for (const Round& round : rounds) {
    head.push_back(round.head_s / std::sqrt(round.base_s * round.base_again_s));
    again.push_back(round.base_again_s / round.base_s);
  }
  const std::vector<double> ones(rounds.size(), 1.0);
  Slowdown slowdown{.head = ratio_of_medians(head, ones, Sampling::kPaired, kBootstrap),
                    .noise = ratio_of_medians(again, ones, Sampling::kPaired, kBootstrap),
                    .num_rounds = static_cast<int>(rounds.size())};
  const double noise = std::max(slowdown.noise.value, 1 / slowdown.noise.value);
  if (slowdown.head.low > kNoticeable && slowdown.head.value > kNoticeable * noise)
    slowdown.answer = Answer::kSlower;
  else if (slowdown.head.high < kSevere)
    slowdown.answer = Answer::kNotSlower;
  return slowdown;
}

}  // namespace

const char* to_string(Answer answer) {
  switch (answer) {
    case Answer::kNotSlower:
      return "not slower";
    case Answer::kSlower:
      return "slower";
    case Answer::kCannotTell:
      break;
  }
  return "cannot tell";
}

Slowdown measure_slowdown(const std::function<Round()>& next_round) {
  std::vector<Round> rounds;
  Slowdown slowdown;
  for (int num_rounds = kFewestRounds; num_rounds <= kMostRounds; num_rounds += kMoreRounds) {
    while (static_cast<int>(rounds.size()) < num_rounds) rounds.push_back(next_round());
    slowdown = judge(rounds);
    if (slowdown.answer != Answer::kCannotTell) break;
  }
  return slowdown;
}

}  // namespace podm::bench
