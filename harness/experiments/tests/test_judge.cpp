// Tests of rows that make each kind of claim hold or fail, and of rows that decide nothing.
#include "experiments/judge.h"

#include <gtest/gtest.h>

#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

using Rows = std::vector<Row>;

constexpr auto kHolds = Verdict::kHolds, kFails = Verdict::kDoesNotHold, kUnclear = Verdict::kNotResolved,
               kOpen = Verdict::kCannotBeDecided;

Rows operator+(Rows a, const Rows& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Judges the rows of one round as if each of six rounds had the same rows.
Judgement judged(const Claim& claim, const Rows& rows) { return judge(claim, in_six_rounds(rows)); }

Verdict verdict_of(const Claim& claim, const Rows& rows) { return judged(claim, rows).verdict; }

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

// The row of a trial that made no mesh.
Row failed(Row row, Status status = Status::kTimedOut) {
  row.status = status;
  row.reason = "killed after 300 s";
  row.mesh.reset();
  return row;
}

TEST(JudgeBound, HoldsInEveryGroupOrNot) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'bound'\nvalue = 'refining_seconds'\nat_least = 1\nat_most = 2\n");
  const Rows fine{refined_in(1.5, {{"threads", 1}}), refined_in(1.9, {{"threads", 2}})};
  EXPECT_EQ(verdict_of(claim, fine), kHolds);
  for (const double seconds : {0.9, 2.1}) {
    const Judgement judgement = judged(claim, fine + Rows{refined_in(seconds, {{"threads", 4}})});
    EXPECT_EQ(judgement.verdict, kFails);
    EXPECT_EQ(judgement.value, seconds);
    EXPECT_EQ(judgement.num_rows, 18u);
    EXPECT_TRUE(has(judgement.reason, "threads=4")) << judgement.reason;
  }
}

TEST(JudgeBound, OfTimesIsAboutTheMedianOfRepeats) {
  const Claim claim =
      read_claim_of("basis = 'measured'\nkind = 'bound'\nvalue = 'refining_seconds'\nat_most = 2\n");
  const auto rows = [](const std::vector<double>& seconds) {
    Rows made;
    for (const double s : seconds) made.push_back(refined_in(s, {}, static_cast<int>(made.size()) + 1));
    return made;
  };
  EXPECT_EQ(judge(claim, rows({1.0, 1.5, 9.0})).value, 1.5);
  EXPECT_EQ(judge(claim, rows({1, 1, 1, 1.9, 1.9, 1.9})).verdict, kHolds);
  EXPECT_EQ(judge(claim, rows({9, 9, 9, 2.1, 2.1, 2.1})).verdict, kFails);
  EXPECT_EQ(judge(claim, rows({1, 1, 1, 1, 1, 9})).verdict, kUnclear) << "six rounds leave no outlier aside";
  EXPECT_EQ(judge(claim, rows({1, 1, 1, 1, 1, 1, 1, 1, 9})).verdict, kHolds) << "nine leave one aside";
}

TEST(JudgeBound, OfFaultsIsAboutEachRepeatAndUnmetRowsToo) {
  const Claim claim =
      read_claim_of("basis = 'any'\nkind = 'bound'\nvalue = 'guarantee_misses'\nat_most = 0\n");
  Rows rows;
  for (int repeat = 1; repeat <= 3; ++repeat) {
    rows.push_back(synthetic_row("1M", {}, repeat));
    mesh_of(rows.back()).guarantees = {{"radius_edge", 0}, {"facet_angle", 0}};
  }
  EXPECT_EQ(judge(claim, rows).verdict, kHolds);
  mesh_of(rows[1]).guarantees["facet_angle"] = 1;
  rows[1].status = Status::kUnmet;
  EXPECT_EQ(judge(claim, rows).value, 1);
  EXPECT_EQ(judge(claim, rows).verdict, kFails) << "one in three";
  EXPECT_EQ(judge(claim, rows + Rows{failed(rows[0])}).verdict, kFails) << "a failed row takes nothing back";
  EXPECT_EQ(judge(claim, {rows[0], failed(rows[2])}).verdict, kOpen);
}

const char* kRatio = R"(
basis = "measured"
kind = "ratio"
value = "refining_seconds"
of = {algorithm = "pdr-podm"}
over = {algorithm = "podm"}
at_most = 1.1
)";

TEST(JudgeRatio, ComparesWithinGroupsOfEqualOptions) {
  const Claim claim = read_claim_of(kRatio);
  // podm takes 1 s on one thread and 0.5 s on two.
  const auto rows = [](double one, double two) {
    return Rows{refined_in(1, {{"algorithm", "podm"}, {"threads", 1}}),
                refined_in(one, {{"algorithm", "pdr-podm"}, {"threads", 1}}),
                refined_in(0.5, {{"algorithm", "podm"}, {"threads", 2}}),
                refined_in(two, {{"algorithm", "pdr-podm"}, {"threads", 2}})};
  };
  EXPECT_EQ(verdict_of(claim, rows(1.05, 0.5)), kHolds);
  const Judgement judgement = judged(claim, rows(1.05, 0.6));
  EXPECT_EQ(judgement.verdict, kFails) << "0.6 is less than 1 s of another number of threads";
  EXPECT_NEAR(*judgement.value, 1.2, 1e-12);
  EXPECT_TRUE(has(judgement.reason, "1 of 2 hold; threads=2: 0.6 over 0.5 s")) << judgement.reason;
}

TEST(JudgeRatio, IsTheMedianOfRatiosWithinRounds) {
  const Claim claim = read_claim_of(kRatio);
  Rows rows;
  // Each round runs on a slower machine. The ratio is 1.05 within each round; the medians alone would give
  // the same ratio in any order.
  for (int round = 1; round <= 3; ++round) {
    rows.push_back(refined_in(round, {{"algorithm", "podm"}}, round));
    rows.push_back(refined_in(1.05 * round, {{"algorithm", "pdr-podm"}}, round));
  }
  Judgement judgement = judge(claim, rows);
  EXPECT_NEAR(*judgement.value, 1.05, 1e-12);
  EXPECT_TRUE(has(judgement.reason, "1.05 to 1.05 holds the median with 75.0 % (3 rounds)"))
      << judgement.reason;
  // Rounds of 1, 2, 3 s against 3, 1, 2 s: ratios 3, 1/2 and 2/3, while the medians are equal.
  const double seconds[] = {3, 1, 2};
  for (int round = 0; round < 3; ++round)
    rows[static_cast<std::size_t>(2 * round + 1)] =
        refined_in(seconds[round], {{"algorithm", "pdr-podm"}}, round + 1);
  judgement = judge(claim, rows);
  EXPECT_NEAR(*judgement.value, 2.0 / 3, 1e-12);
}

TEST(JudgeRatio, OfSeriesWithoutCommonRoundsIsThatOfMedians) {
  const Claim claim = read_claim_of(kRatio);
  Rows rows;
  for (int round = 1; round <= 3; ++round) {
    rows.push_back(refined_in(round, {{"algorithm", "podm"}}, round));
    rows.push_back(refined_in(round, {{"algorithm", "pdr-podm"}}, round + 3));
  }
  const Judgement judgement = judge(claim, rows);
  EXPECT_EQ(judgement.value, 1);
  EXPECT_TRUE(has(judgement.reason, "0.333 to 3 holds the median with 56.2 % (3 rounds)"))
      << judgement.reason;
}

TEST(JudgeRatio, OverTheBestOfTheOthers) {
  const auto claim_of = [](const std::string& measure) {
    return read_claim_of("basis = 'measured'\nkind = 'ratio'\nvalue = '" + measure +
                         "'\nof = {contention = 'local'}\nover = 'best of the others'\nat_least = 0.9\n"
                         "at_most = 1.1\n");
  };
  const Rows rows{refined_in(2, {{"contention", "local"}}), refined_in(1, {{"contention", "random"}}),
                  refined_in(4, {{"contention", "aggressive"}})};
  const Judgement seconds = judged(claim_of("refining_seconds"), rows);
  EXPECT_EQ(seconds.value, 2) << "the best takes the least time";
  EXPECT_TRUE(has(seconds.reason, "contention=random")) << seconds.reason;
  EXPECT_EQ(judged(claim_of("refining_cells_per_second"), rows).value, 0.5) << "the best makes the most";
  EXPECT_EQ(
      verdict_of(claim_of("refining_seconds"), {refined_in(1, {{"contention", "local"}}), rows[1], rows[2]}),
      kHolds);
  EXPECT_EQ(verdict_of(claim_of("refining_seconds"), {rows[0]}), kOpen) << "nobody to compare with";
}

TEST(JudgeRatio, ChoosesAmongSeriesThatDifferInAnOptionOfBoth) {
  const Claim claim = read_claim_of(R"(
basis = "measured"
kind = "ratio"
value = "refining_cells_per_second"
of = {algorithm = "pdr-podm", contention = "local"}
over = "best of the others"
at_least = 0.95
)");
  const auto row = [](const char* algorithm, double rate) {
    return refined_in(1 / rate, {{"algorithm", algorithm}});
  };
  const auto with_option = [](double rate) {
    return refined_in(1 / rate, {{"algorithm", "pdr-podm"}, {"contention", "local"}});
  };
  const Rows others{row("podm", 2), row("pdr-podm", 1)};
  EXPECT_DOUBLE_EQ(*judged(claim, {with_option(2), others[0], others[1]}).value, 1);
  EXPECT_DOUBLE_EQ(*judged(claim, {with_option(1), others[0], others[1]}).value, 0.5);
}

TEST(JudgeRatio, OverOneThreadIsTheBaseOfAllNumbersOfThreads) {
  const Claim claim = read_claim_of(R"(
basis = "measured"
kind = "ratio"
value = "refining_cells_per_second_and_core"
of = {algorithm = "podm"}
over = {algorithm = "podm", threads = 1}
across = "target_elements"
at_least = 0.7
)");
  // A thousand cells per thread in the given seconds, on 1, 2 and 4 threads.
  const auto rows = [](std::vector<double> seconds) {
    Rows made;
    int threads = 1;
    for (const double s : seconds) {
      made.push_back(
          refined_in(s, {{"algorithm", "podm"}, {"threads", threads}, {"target_elements", 1000 * threads}}));
      mesh_of(made.back()).cells = static_cast<std::uint64_t>(1000 * threads);
      threads *= 2;
    }
    return made;
  };
  EXPECT_EQ(verdict_of(claim, rows({1, 1.1, 1.3})), kHolds);
  const Judgement judgement = judged(claim, rows({1, 1.1, 2}));
  EXPECT_EQ(judgement.verdict, kFails);
  EXPECT_EQ(judgement.value, 0.5);
  EXPECT_TRUE(has(judgement.reason, "1 of 2 hold")) << judgement.reason;
  EXPECT_TRUE(has(judgement.reason, "threads=4")) << judgement.reason;
  EXPECT_EQ(verdict_of(claim, rows({1})), kOpen) << "one thread says nothing of others";
}

TEST(JudgeRatio, ImagesAreGroupsUnlessTheyMayDiffer) {
  Rows rows{refined_in(1, {{"algorithm", "podm"}}), refined_in(1, {{"algorithm", "pdr-podm"}})};
  rows[1].input.name = "another";
  EXPECT_EQ(verdict_of(read_claim_of(kRatio), rows), kOpen);
  EXPECT_EQ(verdict_of(read_claim_of(std::string(kRatio) + "across = 'input'\n"), rows), kHolds);
}

TEST(JudgeRatio, OverNothingIsInfiniteAndOfNothingIsOne) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'ratio'\nvalue = 'lost_seconds'\nof = {contention = 'local'}\n"
      "over = {contention = 'random'}\nat_most = 1.1\n");
  const auto rows = [](double local, double random) {
    Rows made{synthetic_row("1M", {{"contention", "local"}}),
              synthetic_row("1M", {{"contention", "random"}})};
    set_overhead(made[0], local, 0, 5);
    set_overhead(made[1], random, 0, 0);
    return made;
  };
  EXPECT_EQ(verdict_of(claim, rows(0, 0)), kHolds);
  EXPECT_EQ(verdict_of(claim, rows(0, 1)), kHolds);
  const Judgement judgement = judged(claim, rows(1, 0));
  EXPECT_EQ(judgement.verdict, kFails);
  EXPECT_FALSE(judgement.value) << "infinity is no number of JSON's";
}

TEST(JudgeOrder, OneSeriesIsAboveTheOtherInEveryGroup) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'order'\nvalue = 'refining_cells_per_second'\nabove = {algorithm = "
      "'podm'}\n"
      "below = {algorithm = 'pdr-podm'}\n");
  const auto rows = [](double podm, double pdr_podm) {
    return Rows{refined_in(podm, {{"algorithm", "podm"}}), refined_in(pdr_podm, {{"algorithm", "pdr-podm"}})};
  };
  EXPECT_EQ(verdict_of(claim, rows(1, 1.01)), kHolds) << "less time, more cells a second";
  EXPECT_EQ(verdict_of(claim, rows(1, 0.99)), kFails);
  EXPECT_EQ(verdict_of(claim, rows(1, 1)), kFails) << "as many is not more";
  Rows on_two_inputs = rows(1, 2);
  for (const Row& row : rows(2, 1)) on_two_inputs.push_back(row);
  for (std::size_t i = 2; i < 4; ++i) on_two_inputs[i].input.name = "another";
  EXPECT_EQ(verdict_of(claim, on_two_inputs), kFails);
}

TEST(JudgeTrend, FallsByAFactorPerDoublingUpToOneSocket) {
  const Claim claim = read_claim_of(R"(
basis = "measured"
kind = "trend"
value = "refining_seconds"
extent = "one socket"
along = "threads"
direction = "falls"
factor_per_doubling = 1.4
)");
  const auto rows = [](const std::map<int, double>& seconds) {
    Rows made;
    for (const auto& [threads, s] : seconds) made.push_back(refined_in(s, {{"threads", threads}}));
    return made;
  };
  EXPECT_EQ(verdict_of(claim, rows({{1, 8}, {2, 5}, {4, 3}, {8, 2}})), kHolds);
  EXPECT_EQ(verdict_of(claim, rows({{1, 8}, {2, 5}, {4, 3}, {8, 2}, {16, 2}})), kHolds)
      << "16 are two sockets";
  EXPECT_EQ(verdict_of(claim, rows({{1, 8}, {2, 5}, {4, 4}, {8, 2}})), kFails);
  EXPECT_EQ(verdict_of(claim, rows({{1, 8}, {8, 3}})), kFails) << "2.67 in three doublings is 1.39 each";
  EXPECT_EQ(verdict_of(claim, rows({{1, 8}, {8, 2.9}})), kHolds);
  const Judgement one = judged(claim, rows({{1, 8}, {16, 2}}));
  EXPECT_EQ(one.verdict, kOpen);
  EXPECT_EQ(one.reason, "needs two values of threads, has 1");
}

TEST(JudgeTrend, WithoutAFactorMayRestOnTheWayButNotTurn) {
  const auto claim_of = [](const std::string& direction) {
    return read_claim_of(
        "basis = 'measured'\nkind = 'trend'\nvalue = 'deferred_operations'\nalong = 'leaf_size'\n"
        "direction = '" +
        direction + "'\n");
  };
  const auto rows = [](const std::vector<int>& numbers) {
    Rows made;
    double size = 10;
    for (const int number : numbers) {
      made.push_back(synthetic_row("1M", {{"leaf_size", size}}));
      mesh_of(made.back()).outcomes.emplace().out_of_leaf = static_cast<std::uint64_t>(number);
      size *= 2;
    }
    return made;
  };
  EXPECT_EQ(verdict_of(claim_of("falls"), rows({900, 5, 5, 0, 0})), kHolds);
  EXPECT_EQ(verdict_of(claim_of("falls"), rows({900, 5, 6})), kFails);
  EXPECT_EQ(verdict_of(claim_of("falls"), rows({5, 5, 5})), kFails);
  EXPECT_EQ(verdict_of(claim_of("grows"), rows({0, 0, 7})), kHolds);
  EXPECT_EQ(verdict_of(claim_of("grows"), rows({900, 5})), kFails);
}

TEST(JudgeShare, OfTrialsThatEnded) {
  const auto claim_of = [](const std::string& least) {
    return read_claim_of("basis = 'any'\nkind = 'share'\nvalue = 'ended'\nat_least = " + least + "\n");
  };
  const Rows ended(3, synthetic_row("1M", {}));
  EXPECT_EQ(verdict_of(claim_of("1"), ended), kHolds);
  const Rows rows = ended + Rows{failed(synthetic_row("1M", {{"contention", "local"}}))};
  EXPECT_EQ(verdict_of(claim_of("1"), rows), kFails);
  EXPECT_EQ(judged(claim_of("1"), rows).value, 0.75);
  EXPECT_TRUE(has(judged(claim_of("1"), rows).reason, "18 of 24, not 1M"));
  EXPECT_EQ(verdict_of(claim_of("0.75"), rows), kHolds);
}

TEST(JudgeShare, ARefutationStandsBesideRowsThatDecideNothing) {
  const Claim claim = read_claim_of("basis = 'any'\nkind = 'share'\nvalue = 'replay_equal'\nat_least = 1\n");
  using enum Replay::End;
  const auto replayed = [](std::optional<Replay::End> end) {
    Row row = synthetic_row("1M", {});
    if (end) row.replay = {*end, ""};
    return row;
  };
  EXPECT_EQ(verdict_of(claim, {replayed(kEqual), replayed(kDiffers), replayed({})}), kFails);
  EXPECT_EQ(verdict_of(claim, {replayed(kEqual), replayed({})}), kOpen);
  EXPECT_EQ(verdict_of(claim, {replayed({})}), kOpen);
  EXPECT_EQ(verdict_of(claim, {replayed(kEqual)}), kHolds);
}

TEST(JudgeRatio, ASeriesThatFailedDoesNotHideAnotherThatRefutes) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'ratio'\nvalue = 'refining_seconds'\nof = {contention = 'local'}\n"
      "over = 'best of the others'\nat_most = 1.1\n");
  const auto rows = [](double aggressive) {
    return Rows{refined_in(2, {{"contention", "local"}}),
                refined_in(aggressive, {{"contention", "aggressive"}}),
                failed(refined_in(1, {{"contention", "random"}}))};
  };
  EXPECT_EQ(verdict_of(claim, rows(1)), kFails);
  EXPECT_EQ(verdict_of(claim, rows(2)), kOpen);
}

TEST(JudgeTrend, AFailedPlaceDoesNotHideAStepThatRefutes) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'trend'\nvalue = 'refining_seconds'\nalong = 'threads'\n"
      "direction = 'falls'\n");
  const auto rows = [](double on_two) {
    return Rows{refined_in(2, {{"threads", 1}}), refined_in(on_two, {{"threads", 2}}),
                failed(refined_in(1, {{"threads", 4}}))};
  };
  EXPECT_EQ(verdict_of(claim, rows(3)), kFails);
  EXPECT_EQ(verdict_of(claim, rows(1)), kOpen);
}

// Rows of both algorithms at a size; pdr-podm takes `ratio` times as long.
Rows rows_of_size(const std::string& trial, double ratio) {
  return {refined_in(1, {{"algorithm", "podm"}}, 1, trial + ",algorithm=podm"),
          refined_in(ratio, {{"algorithm", "pdr-podm"}}, 1, trial + ",algorithm=pdr-podm")};
}

TEST(JudgeSizes, EachThatHasAllItsRowsIsJudged) {
  const Claim claim = read_claim_of(std::string(kRatio) + "trials = ['10M', '1M', '0.1M']\n");
  const Judgement fine = judged(claim, rows_of_size("0.1M", 1) + rows_of_size("1M", 1.05));
  EXPECT_EQ(fine.verdict, kHolds);
  EXPECT_EQ(fine.sizes, (std::vector<std::string>{"1M", "0.1M"}));
  EXPECT_EQ(fine.num_rows, 24u);
  EXPECT_TRUE(has(fine.reason, "1M: 1.05 over 1 s")) << "the one nearest to breaking it: " << fine.reason;
  EXPECT_TRUE(has(fine.reason, "; judged at 1M, 0.1M")) << fine.reason;
  for (const double large : {1, 2}) {
    const Judgement broken = judged(claim, rows_of_size("0.1M", 3) + rows_of_size("1M", large));
    EXPECT_EQ(broken.verdict, kFails) << "a smaller one that fails is not passed over";
    EXPECT_NEAR(*broken.value, 3, 1e-12);
    EXPECT_TRUE(has(broken.reason, "0.1M: ")) << broken.reason;
  }
}

TEST(JudgeSizes, OneThatLacksRowsCanRefuteAndNoMore) {
  const Claim claim = read_claim_of(std::string(kRatio) + "trials = ['10M', '1M', '0.1M']\n");
  const Rows lonely{rows_of_size("10M", 1)[0]};
  const Judgement judgement = judged(claim, lonely + rows_of_size("1M", 1));
  EXPECT_EQ(judgement.verdict, kHolds);
  EXPECT_EQ(judgement.sizes, (std::vector<std::string>{"1M"})) << "10M lacks pdr-podm";
  const Judgement none = judged(claim, lonely);
  EXPECT_EQ(none.verdict, kOpen);
  EXPECT_EQ(none.reason, "no rows: algorithm=pdr-podm");
  EXPECT_EQ(judged(claim, {}).reason, "no rows: trial 10M or 1M or 0.1M");
}

TEST(JudgeSizes, EachValueOfAListNeedsRowsAtOneSize) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'bound'\nvalue = 'refining_seconds'\nat_most = 2\n"
      "trials = ['10M', '1M']\nwhere = {threads = [32, 64]}\n");
  const auto row = [](const std::string& trial, int threads, double seconds) {
    return Rows{refined_in(seconds, {{"threads", threads}}, 1, trial)};
  };
  EXPECT_EQ(judged(claim, row("10M", 64, 1)).reason, "no rows: threads=32") << "64 threads are not 32";
  EXPECT_EQ(verdict_of(claim, row("10M", 64, 1) + row("1M", 32, 1)), kOpen);
  const Rows all = row("1M", 32, 1) + row("1M", 64, 1);
  EXPECT_EQ(verdict_of(claim, all), kHolds);
  EXPECT_EQ(verdict_of(claim, all + row("10M", 64, 1)), kHolds);
  EXPECT_EQ(verdict_of(claim, all + row("10M", 64, 3)), kFails);
}

TEST(JudgeSizes, OneOfTooFewRoundsIsSetAsideWhereItsMedianAgrees) {
  const Claim claim = read_claim_of(std::string(kRatio) + "trials = ['10M', '1M', '0.1M']\n");
  const Rows six = in_six_rounds(rows_of_size("1M", 1));
  const Judgement fine = judge(claim, six + rows_of_size("0.1M", 1));
  EXPECT_EQ(fine.verdict, kHolds);
  EXPECT_EQ(fine.sizes, (std::vector<std::string>{"1M"}));
  EXPECT_TRUE(has(fine.reason, "too few rounds: 0.1M")) << fine.reason;
  EXPECT_EQ(judge(claim, six + rows_of_size("0.1M", 2)).verdict, kUnclear)
      << "one round is against the claim";
  EXPECT_EQ(judge(claim, rows_of_size("1M", 1) + rows_of_size("0.1M", 1)).verdict, kUnclear);
  EXPECT_EQ(judge(claim, in_six_rounds(rows_of_size("1M", 2)) + rows_of_size("0.1M", 1)).verdict, kFails);
}

// pdr-podm takes the given ratio of the time in each round.
Rows rounds_of(const std::vector<double>& ratios) {
  Rows rows;
  for (const double ratio : ratios) {
    const int round = static_cast<int>(rows.size() / 2) + 1;
    rows.push_back(refined_in(1, {{"algorithm", "podm"}}, round));
    rows.push_back(refined_in(ratio, {{"algorithm", "pdr-podm"}}, round));
  }
  return rows;
}

TEST(JudgeInterval, ThatStraddlesTheBoundResolvesNothing) {
  const Claim claim = read_claim_of(kRatio);  // at most 1.1
  EXPECT_EQ(judge(claim, rounds_of({1, 1.02, 1.04, 1.06, 1.08, 1.09})).verdict, kHolds);
  EXPECT_EQ(judge(claim, rounds_of({1.11, 1.12, 1.13, 1.14, 1.15, 1.16})).verdict, kFails);
  for (const double last : {1.11, 1.5}) {
    const Judgement judgement = judge(claim, rounds_of({1, 1.02, 1.04, 1.06, 1.08, last}));
    EXPECT_EQ(judgement.verdict, kUnclear);
    EXPECT_NEAR(*judgement.value, 1.05, 1e-12);
    EXPECT_EQ(judgement.interval->high, last);
    EXPECT_NEAR(judgement.interval->coverage, 31.0 / 32, 1e-12);
    EXPECT_EQ(judgement.num_rounds, 6u);
    EXPECT_TRUE(has(judgement.reason, "the interval straddles the bound")) << judgement.reason;
    ASSERT_TRUE(judgement.rounds_needed);
    EXPECT_GT(*judgement.rounds_needed, 6);
  }
}

TEST(JudgeInterval, OfFewRoundsResolvesNothingHoweverClear) {
  const Claim claim = read_claim_of(kRatio);
  for (const double ratio : {0.5, 5.0})
    for (const int rounds : {1, 3, 5}) {
      const Judgement judgement =
          judge(claim, rounds_of(std::vector<double>(static_cast<std::size_t>(rounds), ratio)));
      EXPECT_EQ(judgement.verdict, kUnclear) << ratio << " in " << rounds;
      EXPECT_TRUE(has(judgement.reason, "6 rounds would resolve it")) << judgement.reason;
    }
}

TEST(JudgeInterval, IsNotNeededOfWhatIsTheSameInEachRun) {
  const std::string bound = "kind = 'bound'\nvalue = 'deferred_operations'\nat_most = 5\nbasis = ";
  const auto row = [](const Json& asked) {
    Rows made{synthetic_row("1M", asked)};
    mesh_of(made[0]).outcomes.emplace().out_of_leaf = 4;
    return made;
  };
  const Claim measured = read_claim_of(bound + "'measured'\n"),
              simulated = read_claim_of(bound + "'simulated'\n");
  EXPECT_EQ(judge(measured, row({{"threads", 1}})).verdict, kHolds);
  EXPECT_EQ(judge(measured, row({{"threads", 2}})).verdict, kUnclear) << "threads share the work as it comes";
  EXPECT_EQ(judge(simulated, row({{"threads", 2}, {"executor", "virtual"}})).verdict, kHolds);
}

TEST(JudgeLoad, OtherWorkLeavesUnresolvedWhatVaries) {
  const Claim claim = read_claim_of(kRatio);
  for (const double ratio : {1.0, 2.0}) {
    Rows rows = rounds_of(std::vector<double>(6, ratio));
    rows[3].environment.busy_elsewhere = 1.4;
    EXPECT_NE(judge(claim, rows).verdict, kUnclear) << "less than a tenth of each processor";
    rows[3].environment.busy_elsewhere = 3.2;
    const Judgement judgement = judge(claim, rows);
    EXPECT_EQ(judgement.verdict, kUnclear);
    EXPECT_TRUE(has(judgement.reason, "other work kept 3.2 processors busy")) << judgement.reason;
  }
}

TEST(JudgeLoad, FaultsOfAMeshCountOnABusyMachineToo) {
  const Claim claim =
      read_claim_of("basis = 'any'\nkind = 'bound'\nvalue = 'guarantee_misses'\nat_most = 0\n");
  Rows rows{synthetic_row("1M", {})};
  rows[0].environment.busy_elsewhere = 16.0;
  mesh_of(rows[0]).guarantees = {{"radius_edge", 1}};
  EXPECT_EQ(judge(claim, rows).verdict, kFails);
}

TEST(JudgeLoad, ATrialThatDidNotEndOnABusyMachineRefutesNothing) {
  const Claim claim = read_claim_of("basis = 'any'\nkind = 'share'\nvalue = 'ended'\nat_least = 1\n");
  Rows rows{synthetic_row("1M", {}), failed(synthetic_row("1M", {}))};
  EXPECT_EQ(judge(claim, rows).verdict, kFails);
  rows[1].environment.busy_elsewhere = 16.0;
  const Judgement judgement = judge(claim, rows);
  EXPECT_EQ(judgement.verdict, kUnclear);
  EXPECT_TRUE(has(judgement.reason, "1M: other work kept 16.0 processors busy")) << judgement.reason;
  rows.push_back(failed(synthetic_row("1M", {}), Status::kFailed));
  EXPECT_EQ(judge(claim, rows).verdict, kFails) << "a crash is no matter of time";
}

TEST(JudgeLoad, RoundsOfAnotherSpeedAreLeftOut) {
  const Claim claim = read_claim_of(kRatio);
  Rows rows = rounds_of({1, 1, 1, 1, 1, 1, 9});
  EXPECT_EQ(judge(claim, rows).verdict, kUnclear);
  for (std::size_t i = 12; i < 14; ++i) rows[i].probe_moved = true;
  EXPECT_EQ(judge(claim, rows).verdict, kHolds);
  for (Row& row : rows) row.probe_moved = true;
  EXPECT_EQ(judge(claim, rows).verdict, kOpen);
  EXPECT_TRUE(has(judge(claim, rows).reason, "the machine's speed moved during each round"));
}

TEST(Judge, AFailedLargeSizeIsNotPassedOver) {
  const Claim claim = read_claim_of(std::string(kRatio) + "trials = ['10M', '1M']\n");
  const Rows rows{refined_in(1, {{"algorithm", "podm"}}, 1, "10M"),
                  failed(refined_in(1, {{"algorithm", "pdr-podm"}}, 1, "10M")),
                  refined_in(1, {{"algorithm", "podm"}}, 1, "1M"),
                  refined_in(1, {{"algorithm", "pdr-podm"}}, 1, "1M")};
  const Judgement judgement = judged(claim, rows);
  EXPECT_EQ(judgement.verdict, kOpen);
  EXPECT_EQ(judgement.reason, "rows failed: 10M: timed_out: killed after 300 s");
}

TEST(Judge, AGroupThatBreaksTheClaimDecidesAndOneThatLacksRowsLeavesItOpen) {
  const Claim claim = read_claim_of(kRatio);
  const Rows broken{refined_in(1, {{"algorithm", "podm"}, {"seed", 1}}),
                    refined_in(2, {{"algorithm", "pdr-podm"}, {"seed", 1}})};
  const Rows fine{refined_in(1, {{"algorithm", "podm"}, {"seed", 2}}),
                  refined_in(1, {{"algorithm", "pdr-podm"}, {"seed", 2}})};
  const Rows half{refined_in(1, {{"algorithm", "podm"}, {"seed", 3}})};
  EXPECT_EQ(verdict_of(claim, fine + half), kOpen);
  EXPECT_TRUE(has(judged(claim, fine + half).reason, "seed=3: no rows: algorithm=pdr-podm"));
  EXPECT_EQ(verdict_of(claim, fine + half + broken), kFails);
}

TEST(Judge, EachValueOfAListNeedsRowsAndARangeDoesNot) {
  const std::string share = "basis = 'any'\nkind = 'share'\nvalue = 'ended'\nat_least = 1\nwhere = ";
  const Rows rows{synthetic_row("1M", {{"contention", "local"}, {"threads", 4}})};
  EXPECT_EQ(verdict_of(read_claim_of(share + "{contention = 'local'}\n"), rows), kHolds);
  const Judgement judgement = judged(read_claim_of(share + "{contention = ['local', 'random']}\n"), rows);
  EXPECT_EQ(judgement.verdict, kOpen);
  EXPECT_EQ(judgement.reason, "no rows: contention=random");
  EXPECT_EQ(verdict_of(read_claim_of(share + "{threads = {at_least = 2, at_most = 8}}\n"), rows), kHolds);
  EXPECT_EQ(verdict_of(read_claim_of(share + "{threads = {at_least = 5}}\n"), rows), kOpen);
}

TEST(Judge, EachSeriesOfAListIsComparedAndNeeded) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'order'\nvalue = 'refining_cells_per_second'\nabove = {contention = "
      "'local'}\n"
      "below = {contention = ['random', 'aggressive']}\n");
  const auto rows = [](double random, double aggressive) {
    return Rows{refined_in(1, {{"contention", "local"}}), refined_in(random, {{"contention", "random"}}),
                refined_in(aggressive, {{"contention", "aggressive"}})};
  };
  EXPECT_EQ(verdict_of(claim, rows(2, 3)), kHolds);
  EXPECT_EQ(verdict_of(claim, rows(2, 0.5)), kFails);
  EXPECT_EQ(verdict_of(claim, rows(0.5, 2)), kFails);
  Rows one = rows(2, 3);
  one.pop_back();
  EXPECT_EQ(judged(claim, one).reason, "no rows: contention=aggressive");
}

TEST(Judge, AnOptionThatIsNotGivenIsNone) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'ratio'\nvalue = 'refining_seconds'\nof = {leaf_size = 'none'}\n"
      "over = 'best of the others'\nat_most = 1.1\n");
  const auto rows = [](double own) {
    return Rows{refined_in(own, {}), refined_in(1, {{"leaf_size", 10.0}}),
                refined_in(2, {{"leaf_size", 20.0}})};
  };
  EXPECT_EQ(verdict_of(claim, rows(1.05)), kHolds);
  EXPECT_EQ(verdict_of(claim, rows(1.5)), kFails);
}

TEST(Judge, RowsOfAnotherBasisNeverEnter) {
  const std::string lines = "kind = 'bound'\nvalue = 'lost_seconds'\nat_most = 1\nbasis = ";
  Rows rows{synthetic_row("1M", {}), synthetic_row("1M", {{"executor", "virtual"}}),
            synthetic_row("1M", {{"topology", "machine.xml"}}),
            synthetic_row("1M", {{"counters", "cachegrind"}})};
  for (Row& row : rows) set_overhead(row, 5, 0, 0);
  set_overhead(rows[0], 0.5, 0, 0);
  const Judgement measured = judged(read_claim_of(lines + "'measured'\n"), rows);
  EXPECT_EQ(measured.verdict, kHolds);
  EXPECT_EQ(measured.num_rows, 6u);
  const Judgement simulated = judged(read_claim_of(lines + "'simulated'\n"), rows);
  EXPECT_EQ(simulated.verdict, kFails);
  EXPECT_EQ(simulated.num_rows, 18u);
}

TEST(Judge, MachinesTooSmallDecideNothing) {
  const Claim claim = read_claim_of(std::string(kRatio) + "needs_cores = 17\n");
  const Rows rows{refined_in(1, {{"algorithm", "podm"}}), refined_in(1, {{"algorithm", "pdr-podm"}})};
  EXPECT_EQ(judged(claim, rows).reason, "needs 17 cores, has 16");
  EXPECT_EQ(verdict_of(read_claim_of(std::string(kRatio) + "needs_cores = 16\n"), rows), kHolds);
}

TEST(Judge, MostThreadsAreThoseOfTheRows) {
  const Claim claim = read_claim_of(std::string(kRatio) + "extent = 'most threads'\n");
  const auto rows = [](int threads, double ratio) {
    return Rows{refined_in(1, {{"algorithm", "podm"}, {"threads", threads}}),
                refined_in(ratio, {{"algorithm", "pdr-podm"}, {"threads", threads}})};
  };
  EXPECT_EQ(verdict_of(claim, rows(1, 2) + rows(8, 1)), kHolds);
  EXPECT_EQ(verdict_of(claim, rows(1, 1) + rows(8, 2)), kFails);
}

TEST(Judge, SkippedRowsSayWhy) {
  const Claim claim = read_claim_of(
      "basis = 'measured'\nkind = 'order'\nvalue = 'refining_cells_per_second'\nabove = {mesher = 'podm'}\n"
      "below = {mesher = 'other'}\n");
  Rows rows{refined_in(1, {}), failed(refined_in(1, {{"mesher", "other"}}), Status::kSkipped)};
  rows[1].reason = "not installed";
  EXPECT_EQ(judged(claim, rows).reason, "no rows: mesher=other (1M skipped: not installed)");
  EXPECT_EQ(verdict_of(claim, {rows[0], refined_in(2, {{"mesher", "other"}})}), kHolds);
}

}  // namespace
}  // namespace podm::bench
