// Tests of the load by other work, with synthetic files of the kernel and on this machine.
#include "machine/load_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <sstream>

namespace podm::bench {
namespace {

constexpr double kTicks = 100;

std::optional<double> busy(const std::string& text, const std::vector<int>& processors) {
  std::istringstream file(text);
  return busy_seconds(file, processors, kTicks);
}

TEST(LoadWatch, CountsWorkInterruptsAndStealOfTheUsableProcessors) {
  const std::string stat =
      "cpu  1000 1000 1000 9000 9000 1000 1000 1000 500 500\n"
      "cpu0 100 10 20 7000 8000 1 2 40 55 66\n"
      "cpu1 200 0 0 0 0 0 0 0 0 0\n"
      "cpu10 900 0 0 0 0 0 0 0 0 0\n"
      "intr 99\n";
  EXPECT_EQ(busy(stat, {0}), 1.73) << "neither idle nor waiting for a disk, and guests once";
  EXPECT_EQ(busy(stat, {1}), 2.0);
  EXPECT_EQ(busy(stat, {0, 1}), 3.73);
  EXPECT_EQ(busy(stat, {}), 60.0) << "all, where the usable ones are unknown";
  EXPECT_EQ(busy(stat, {0, 2}), std::nullopt);
  EXPECT_EQ(busy("", {0}), std::nullopt);
}

double elsewhere(const ProcessorUse& before, const ProcessorUse& after) {
  return std::get<double>(busy_elsewhere(before, after));
}

TEST(LoadWatch, IsTheMeanOfWhatIsLeftWhenOnesOwnWorkIsTaken) {
  EXPECT_DOUBLE_EQ(elsewhere({10, 5.0, 3}, {12, 8.0, 4.5}), 0.75);
  EXPECT_DOUBLE_EQ(elsewhere({10, 5.0, 3}, {12, 6.5, 4.5}), 0);
  EXPECT_DOUBLE_EQ(elsewhere({10, 5.0, 3}, {12, 6.4, 4.5}), 0) << "a tick is less than none";
}

TEST(LoadWatch, GrowsWithTheWorkOfOthersAlone) {
  for (const double own : {0.0, 1.0, 4.0})
    for (const double others : {0.0, 0.5, 3.0})
      EXPECT_DOUBLE_EQ(elsewhere({0, 0.0, 0}, {2, own + others, own}), others / 2);
}

TEST(LoadWatch, SaysWhyItCannotKnow) {
  const auto why = [](const ProcessorUse& before, const ProcessorUse& after) {
    return std::get<Unavailable>(busy_elsewhere(before, after)).why;
  };
  EXPECT_EQ(why({0, 1.0, 0}, {0.1, 1.1, 0}), "the trial took less than 0.2 s");
  EXPECT_EQ(why({0, {}, 0}, {2, 1.0, 0}), "/proc/stat does not list the usable processors");
  EXPECT_EQ(why({0, 0.0, 0}, {2, 0.0, 2}), "/proc/stat does not count the trial's own work");
}

// The load does not count this test's own work. The bound leaves room for the machine's other work.
TEST(LoadWatch, OwnWorkIsOnesOwn) {
  const ProcessorUse before = processor_use();
  const auto start = std::chrono::steady_clock::now();
  volatile double sum = 0;
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(400)) sum = sum + 1;
  const ProcessorUse after = processor_use();
  EXPECT_GT(after.own_s, before.own_s);
  EXPECT_GE(after.wall_s - before.wall_s, 0.4);
  if (!after.busy_s) GTEST_SKIP() << "skipped: /proc/stat cannot be read";
  EXPECT_LE(elsewhere(before, after), (*after.busy_s - *before.busy_s) / (after.wall_s - before.wall_s));
}

}  // namespace
}  // namespace podm::bench
