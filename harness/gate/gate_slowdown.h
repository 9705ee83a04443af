// Whether one program is slower than another, told by processes run in turn on a machine of changing speed.
#pragma once

#include <cstdint>
#include <functional>

#include "rows/statistics.h"

namespace podm::bench {

/// Seconds of three processes run one right after the other, in an order drawn anew each round. The base is
/// run twice: a difference between those two is noise.
struct Round {
  double base_s = 0, base_again_s = 0, head_s = 0;
};

enum class Answer { kNotSlower, kSlower, kCannotTell };
/// "not slower", "slower", "cannot tell".
const char* to_string(Answer answer);

struct Slowdown {
  Answer answer = Answer::kCannotTell;
  Ratio head;   ///< head over base
  Ratio noise;  ///< base over base
  int num_rounds = 0;
};

/// The rule: slower when the interval of the ratio lies above kNoticeable and the ratio above that and the
/// noise, not slower when the interval lies below kSevere. More rounds are asked for until one holds. In
/// 9000 simulated tries (tests/test_gate.cpp) it called none of equal programs slower, and 99.7 % of those
/// that were slower by 10 %.
inline constexpr double kNoticeable = 1.03, kSevere = 1.07;
inline constexpr int kFewestRounds = 7, kMostRounds = 63, kMoreRounds = 8;

/// Asks for as many rounds as the answer takes; what `next_round` throws passes through.
Slowdown measure_slowdown(const std::function<Round()>& next_round);

}  // namespace podm::bench
