#include "experiments/decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm::bench {
namespace {

bool is_beyond(const Bounds& bounds, const Interval& interval) {
  const bool is_below = bounds.at_least && (bounds.is_strict ? interval.high <= *bounds.at_least
                                                             : interval.high < *bounds.at_least);
  return is_below || (bounds.at_most && interval.low > *bounds.at_most);
}

// Returns the number of rounds that keep the interval off each bound.
std::optional<int> rounds_needed(const Bounds& bounds, const Estimate& estimate) {
  int most = 0;
  for (const auto& bound : {bounds.at_least, bounds.at_most}) {
    if (!bound) continue;
    const auto needed = samples_needed(estimate.samples, *bound);
    if (!needed) return {};
    most = std::max(most, *needed);
  }
  return std::max(most, static_cast<int>(estimate.num_rounds) + 1);
}

std::string with_rounds(const std::string& doubt, const std::optional<int>& rounds) {
  return rounds ? fmt::format("{}; about {} rounds would resolve it", doubt, *rounds)
                : fmt::format("{}; at least {} rounds would resolve it", doubt, fewest_samples());
}

std::string describe_few(std::size_t num_rounds) {
  return num_rounds < 2 ? "one round has no interval"
                        : fmt::format("{} rounds are too few for {:g} %", num_rounds, 100 * kConfidence);
}

}  // namespace

bool Bounds::contain(double value) const {
  if (at_least && (is_strict ? value <= *at_least : value < *at_least)) return false;
  return !at_most || value <= *at_most;
}

double Bounds::excess(double value) const {
  const auto scale = [](double bound) { return bound == 0 ? 1 : std::abs(bound); };
  double excess = -std::numeric_limits<double>::infinity();
  if (at_least) excess = std::max(excess, (*at_least - value) / scale(*at_least));
  if (at_most) excess = std::max(excess, (value - *at_most) / scale(*at_most));
  return excess;
}

Bounds bounds_of(const Claim& claim) {
  if (claim.kind == ClaimKind::kOrder) return {1, {}, true};
  return {claim.at_least, claim.at_most, false};
}

Decision decide(const Bounds& bounds, const Estimate& estimate) {
  const bool is_within = bounds.contain(estimate.value);
  Decision decision;
  if (!estimate.interval) {
    decision.outcome = is_within ? Outcome::kHolds : Outcome::kFails;
    return decision;
  }
  if (estimate.busy > 0) {
    decision.doubt = describe_disturbance(estimate.busy);
    return decision;
  }
  const Interval& interval = *estimate.interval;
  if (interval.coverage < kConfidence) {
    decision.rounds_needed = rounds_needed(bounds, estimate);
    decision.agrees_on_few_rounds = is_within;
    decision.doubt = with_rounds(describe_few(estimate.num_rounds), decision.rounds_needed);
  } else if (bounds.contain(interval.low) && bounds.contain(interval.high)) {
    decision.outcome = Outcome::kHolds;
  } else if (is_beyond(bounds, interval)) {
    decision.outcome = Outcome::kFails;
  } else {
    decision.rounds_needed = rounds_needed(bounds, estimate);
    decision.doubt = "the interval straddles the bound";
    if (decision.rounds_needed) decision.doubt = with_rounds(decision.doubt, decision.rounds_needed);
  }
  return decision;
}

std::string describe_interval(const Estimate& estimate) {
  if (!estimate.interval || estimate.num_rounds < 2) return "";
  const Interval& interval = *estimate.interval;
  return fmt::format(", {:.3g} to {:.3g} holds the median with {:.1f} % ({} rounds)", interval.low,
                     interval.high, 100 * interval.coverage, estimate.num_rounds);
}

std::string describe_disturbance(double busy) {
  return fmt::format("other work kept {:.1f} processors busy", busy);
}

}  // namespace podm::bench
