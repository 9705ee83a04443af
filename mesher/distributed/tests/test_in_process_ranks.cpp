#include "distributed/in_process_ranks.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <new>
#include <random>
#include <set>
#include <thread>

#include "communication_cases.h"

namespace podm {
namespace {

using Body = std::function<void(Communication&)>;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint64_t kNumSeeds = 5;

class InProcessRanks : public testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  static InProcessOptions options(std::uint64_t seed = 0) {
    return {.num_ranks = std::get<0>(GetParam()), .one_at_a_time = std::get<1>(GetParam()), .seed = seed};
  }
};

using SeveralRanks = InProcessRanks;  // faults that need more than one rank

std::string name_of(const testing::TestParamInfo<std::tuple<int, bool>>& given) {
  return std::to_string(std::get<0>(given.param)) + (std::get<1>(given.param) ? "OneAtATime" : "AtOnce");
}

INSTANTIATE_TEST_SUITE_P(, InProcessRanks,
                         testing::Combine(testing::Values(1, 2, 3, 5, 8, 64), testing::Bool()), name_of);
INSTANTIATE_TEST_SUITE_P(, SeveralRanks, testing::Combine(testing::Values(2, 3, 5, 8, 64), testing::Bool()),
                         name_of);

TEST_P(InProcessRanks, CarryRandomCollectives) {
  const int num_collectives = options().num_ranks > 8 ? 5 : 60;
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed)
    run_ranks(options(seed),
              [&](Communication& ranks) { test::expect_random_collectives(ranks, seed, num_collectives); });
}

TEST_P(InProcessRanks, CarryMessagesOfAllLengths) {
  run_ranks(options(), [](Communication& ranks) { test::expect_lengths(ranks, 50); });
}

TEST_P(InProcessRanks, WantOneMessagePerRank) { run_ranks(options(), test::expect_one_message_per_rank); }

TEST_P(InProcessRanks, NoneLeavesABarrierBeforeAllHaveCome) { run_ranks(options(), test::expect_barrier); }

TEST_P(InProcessRanks, HearTheLargestAnnouncement) {
  run_ranks(options(),
            [](Communication& ranks) { test::expect_announcements(ranks, std::get<1>(GetParam())); });
}

// Otherwise the order of the ranks would decide which of them hears of it.
TEST_P(SeveralRanks, HearNothingBeforeTheNextCollectiveIfOneComputesAtATime) {
  if (!std::get<1>(GetParam())) return;
  run_ranks(options(), [](Communication& ranks) {
    if (ranks.rank() == 0) ranks.announce(5);
    EXPECT_EQ(ranks.announced(), ranks.rank() == 0 ? 5u : 0u);
    ranks.barrier();
    EXPECT_EQ(ranks.announced(), 5u);
  });
}

TEST_P(InProcessRanks, EachIsThereOnce) {
  std::vector<std::atomic<int>> times(static_cast<std::size_t>(options().num_ranks));
  run_ranks(options(), [&](Communication& ranks) {
    EXPECT_EQ(ranks.size(), options().num_ranks);
    ++times[static_cast<std::size_t>(ranks.rank())];
  });
  for (const std::atomic<int>& n : times) EXPECT_EQ(n, 1);
}

// Returns the text of the exception of run_ranks() if it has this type, otherwise "".
template <class Error>
std::string fault_of(const InProcessOptions& options, const Body& body) {
  try {
    run_ranks(options, body);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

template <class Error>
void expect_fault_of_last(const InProcessOptions& options, const Error& error, const std::string& cause) {
  const int last = options.num_ranks - 1;
  const std::string fault = fault_of<Error>(options, [&](Communication& ranks) {
    ranks.barrier();
    if (ranks.rank() == last) throw error;
    ranks.barrier();
    ADD_FAILURE() << "rank " << ranks.rank() << " went on";
  });
  EXPECT_EQ(fault, fmt::format("rank {} of {}: {}", last, options.num_ranks, cause));
}

TEST_P(InProcessRanks, WhatOneThrowsEndsAllAndKeepsItsType) {
  expect_fault_of_last(options(), InputError("planted"), "planted");
  expect_fault_of_last(options(), InternalError("planted"), "planted");
  expect_fault_of_last(options(), std::bad_alloc(), "out of memory");
  expect_fault_of_last(options(), std::runtime_error("planted"), "planted");
  const std::string fault = fault_of<std::runtime_error>(options(), [](Communication&) { throw 1; });
  EXPECT_THAT(fault, testing::EndsWith(": an exception of unknown type"));
}

TEST_P(InProcessRanks, OthersLearnWhichRankFailed) {
  const int last = options().num_ranks - 1;
  std::atomic<int> num_notified = 0;
  const std::string fault = fault_of<InputError>(options(), [&](Communication& ranks) {
    for (int i = 0; i < 3; ++i) {  // a rank that goes on anyway gets the exception again
      if (i == 1 && ranks.rank() == last) throw InputError("planted");
      try {
        ranks.barrier();
      } catch (const RankFailed& failed) {
        EXPECT_EQ(failed.what(), fmt::format("rank {} of {} failed: planted", last, ranks.size()));
        ++num_notified;
      }
    }
  });
  EXPECT_EQ(fault, fmt::format("rank {} of {}: planted", last, options().num_ranks));
  EXPECT_GE(num_notified, 2 * last);
}

TEST_P(SeveralRanks, DifferentCollectivesAreAFaultThatNamesBoth) {
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const std::string fault = fault_of<InternalError>(options(seed), [](Communication& ranks) {
      if (ranks.rank() == 1) {
        ranks.all_gather({});
      } else {
        ranks.barrier();
      }
    });
    EXPECT_THAT(fault,
                testing::ContainsRegex("rank [0-9]+ of [0-9]+: it called [a-z_]+ where rank [0-9]+ called"));
    EXPECT_THAT(fault, HasSubstr("rank 1 "));
    EXPECT_THAT(fault, HasSubstr("all_gather"));
    EXPECT_THAT(fault, HasSubstr("barrier"));
  }
}

TEST_P(SeveralRanks, SumsOfDifferentLengthsAreAFault) {
  const std::string fault = fault_of<InternalError>(options(), [](Communication& ranks) {
    std::vector<std::uint64_t> values(ranks.rank() == 1 ? 4 : 3);
    ranks.sum(values);
  });
  EXPECT_THAT(fault, AnyOf(HasSubstr("with 3 values, not 4"), HasSubstr("with 4 values, not 3")));
}

TEST_P(SeveralRanks, OneThatEndsEarlyIsAFault) {
  std::set<bool> ended_first;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::string fault = fault_of<InternalError>(options(seed), [](Communication& ranks) {
      ranks.barrier();
      if (ranks.rank() != 1) ranks.all_gather({});
    });
    EXPECT_THAT(fault,
                AnyOf(HasSubstr(": it called all_gather where rank 1 ended"),
                      testing::ContainsRegex("rank 1 of .*: it ended where rank [0-9]+ called all_gather")));
    ended_first.insert(fault.find("where rank 1 ended") != std::string::npos);
  }
  // Different seeds draw both orders.
  EXPECT_TRUE(!options().one_at_a_time || options().num_ranks > 5 || ended_first.size() == 2);
}

// A random rank fails in a random way at a random moment. The run ends and names the rank.
TEST_P(SeveralRanks, NoFaultMakesThemHang) {
  const std::uint64_t num_seeds = options().num_ranks > 8 ? 8 : 40;
  for (std::uint64_t seed = 0; seed < num_seeds; ++seed) {
    std::mt19937_64 random(seed);
    const int culprit = static_cast<int>(random() % static_cast<std::uint64_t>(options().num_ranks));
    const int moment = static_cast<int>(random() % 6);
    const std::uint64_t fault = random() % 3;
    const Body body = [&](Communication& ranks) {
      for (int i = 0; i < 6; ++i) {
        if (ranks.rank() == culprit && i == moment) {
          if (fault == 0) throw InternalError("planted");
          if (fault == 1) return;
          ranks.maximum({});
        }
        test::expect_random_collectives(ranks, seed + 1, 1);
      }
    };
    EXPECT_THAT(fault_of<InternalError>(options(seed), body), HasSubstr(fmt::format("rank {} ", culprit)))
        << seed;
  }
}

TEST(OneRankAtATime, NoTwoCompute) {
  std::atomic<int> computing = 0;
  run_ranks({.num_ranks = 20, .one_at_a_time = true}, [&](Communication& ranks) {
    for (int i = 0; i < 10; ++i) {
      EXPECT_EQ(++computing, 1);
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      --computing;
      ranks.barrier();
    }
  });
}

// Returns the order in which ranks computed, `num_turns` times each.
std::vector<int> order_of(std::uint64_t seed, int num_turns) {
  std::vector<int> order;  // only one rank at a time accesses it
  run_ranks({.num_ranks = 6, .one_at_a_time = true, .seed = seed}, [&](Communication& ranks) {
    for (int i = 0; i < num_turns; ++i) {
      order.push_back(ranks.rank());
      ranks.barrier();
    }
  });
  return order;
}

TEST(OneRankAtATime, TheSeedDrawsTheOrderOfEachTurn) {
  EXPECT_EQ(order_of(1, 5), order_of(1, 5));
  EXPECT_NE(order_of(1, 5), order_of(2, 5));
  const std::vector<int> order = order_of(1, 2);
  EXPECT_FALSE(std::equal(order.begin(), order.begin() + 6, order.begin() + 6));
}

TEST(OneRankAtATime, TheFirstOfTwoFailuresIsReported) {
  std::set<std::string> faults;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto fault = [&] {
      return fault_of<InputError>({.num_ranks = 3, .one_at_a_time = true, .seed = seed},
                                  [](Communication& ranks) {
                                    if (ranks.rank() > 0) throw InputError("planted");
                                    ranks.barrier();
                                  });
    };
    EXPECT_EQ(fault(), fault());
    faults.insert(fault());
  }
  EXPECT_EQ(faults, (std::set<std::string>{"rank 1 of 3: planted", "rank 2 of 3: planted"}));
}

TEST(RunRanks, HundredsMeet) {
  const int num_ranks = 300;
  run_ranks({.num_ranks = num_ranks, .one_at_a_time = true}, [&](Communication& ranks) {
    std::vector<std::uint64_t> values{1};
    ranks.sum(values);
    EXPECT_EQ(values[0], 300);
    ranks.all_to_all(std::vector<Bytes>(300, Bytes(3)));
  });
}

TEST(RunRanks, NoneIsAnInputError) {
  EXPECT_THROW(run_ranks({.num_ranks = 0}, [](Communication&) {}), InputError);
}

}  // namespace
}  // namespace podm
