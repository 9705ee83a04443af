// Decides from seconds whether one program is slower than another, on a machine whose speed changes.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>

#include "rows/signed_rank.h"

namespace podm::bench {

/// Seconds of two processes that ran close to each other, in a drawn order (drawn_order.h).
struct Round {
  double base_s = 0, head_s = 0;
};

enum class Answer { kNotSlower, kSlower, kNotResolved };
constexpr std::array<const char*, 3> names_of(Answer) { return {"not slower", "slower", "not resolved"}; }

/// The rule: slower if the interval of head over base lies above kNoticeable; otherwise not slower if it lies
/// below kSevere. An interval that is narrower than kSevere - kNoticeable always gives an answer. The rule
/// looks at the interval after each number of rounds in kLooks and stops at the first look that gives an
/// answer. After the last look the answer is "not resolved".
inline constexpr double kNoticeable = 1.01, kSevere = 1.04;
inline constexpr std::array kLooks{10, 15, 22, 33, 50, 75, 112, 168};
/// The probability that the intervals of all looks hold the true ratio.
inline constexpr double kConfidenceOfLooks = 0.95;

struct Slowdown {
  Answer answer = Answer::kNotResolved;
  CentreEstimate ratio;  ///< head over base
  int num_rounds = 0;

  /// An estimate: the interval narrows with the square root of the number of rounds.
  double rounds_for_an_answer() const;
};

/// Returns the centre of the ratios head over base and its interval at one look. The confidence of a look is
/// raised so that all looks together have kConfidenceOfLooks (Bonferroni). Requires at least one round.
CentreEstimate head_over_base(std::span<const Round> rounds);

/// Takes rounds until there is an answer. Returns nothing if `next_round` runs out of rounds before.
/// Exceptions of `next_round` pass through.
std::optional<Slowdown> measure_slowdown(const std::function<std::optional<Round>()>& next_round);

}  // namespace podm::bench
