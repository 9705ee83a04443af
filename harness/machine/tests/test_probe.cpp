// Tests of bursts and differences of probes, and of a real probe.
#include "machine/probe.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace podm::bench {
namespace {

using Values = std::array<double, 3>;
ProbeRecord probe_of(const Values& values) { return {values[0], values[1], values[2]}; }

TEST(Probe, TheBestBurstCounts) {
  const std::vector<ProbeRecord> bursts{{9, 10, 0.5}, {5, 8, 0.3}, {7, 12, 0.4}};
  EXPECT_EQ(best_of(bursts), (ProbeRecord{5, 12, 0.3}));
  EXPECT_EQ(best_of(std::span(bursts).first(1)), bursts[0]);
}

// However slow one burst is, the best of several bursts does not show it.
TEST(Probe, OneDisturbedBurstDoesNotShow) {
  const ProbeRecord quiet{5, 12, 0.3};
  for (const double factor : {1.5, 10.0, 1000.0}) {
    const std::vector<ProbeRecord> bursts{quiet, {5 * factor, 12 / factor, 0.3 * factor}, quiet};
    EXPECT_FALSE(differ(std::vector{quiet, best_of(bursts)}));
  }
}

TEST(Probe, EachValueThatMovesByMoreThanATenthCountsInBothDirections) {
  const Values quiet{80, 12, 0.3};
  for (std::size_t value = 0; value < quiet.size(); ++value)
    for (const auto& [factor, expected] :
         {std::pair{1.09, false}, {1.11, true}, {1 / 1.09, false}, {1 / 1.11, true}}) {
      Values moved = quiet;
      moved[value] *= factor;
      EXPECT_EQ(differ(std::vector{probe_of(quiet), probe_of(moved)}), expected) << value << " by " << factor;
      EXPECT_EQ(differ(std::vector{probe_of(moved), probe_of(quiet), probe_of(quiet)}), expected);
    }
}

TEST(Probe, FewerThanTwoDoNotDiffer) {
  EXPECT_FALSE(differ({}));
  EXPECT_FALSE(differ(std::vector{ProbeRecord{1, 1, 1}}));
}

TEST(Probe, OfThisMachineHasPositiveValues) {
  const Probe probe = probe_machine();
  ASSERT_TRUE(std::holds_alternative<ProbeRecord>(probe)) << std::get<Unavailable>(probe).why;
  const auto& values = std::get<ProbeRecord>(probe);
  EXPECT_GT(values.chase_ns, 0.1);
  EXPECT_LT(values.chase_ns, 10'000);
  EXPECT_GT(values.triad_gb_per_s, 0.01);
  EXPECT_GT(values.integer_ns, 0.01);
  EXPECT_LT(values.integer_ns, 100);
}

}  // namespace
}  // namespace podm::bench
