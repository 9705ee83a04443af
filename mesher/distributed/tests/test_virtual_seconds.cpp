// The virtual clock of in-process ranks, and the simulated time of the network.
#include <gtest/gtest.h>

#include <thread>

#include "distributed/in_process_ranks.h"
#include "runtime/parallel_for.h"
#include "runtime/processor_seconds.h"

namespace podm {
namespace {

constexpr double kLatency = 1e3, kBytesPerS = 1e-2;  // so slow that processor time does not matter
constexpr double kSecondsOfByte = 1 / kBytesPerS;

// Returns each rank's report of one collective on four ranks, which takes two steps.
template <class Body>
std::vector<RankReport> reports_of(const Body& body) {
  return run_ranks({.num_ranks = 4, .one_at_a_time = true, .latency_s = kLatency, .bytes_per_s = kBytesPerS},
                   body);
}

void expect_network_s(const std::vector<RankReport>& reports, double seconds) {
  for (const RankReport& report : reports) EXPECT_DOUBLE_EQ(report.network_s, seconds);
}

TEST(VirtualSeconds, TreesTakeAStepForEachDoubling) {
  const auto barrier = [](Communication& ranks) { ranks.barrier(); };
  for (const auto& [num_ranks, steps] : {std::pair{1, 0}, {2, 1}, {3, 2}, {4, 2}, {5, 3}, {64, 6}, {65, 7}})
    expect_network_s(run_ranks({.num_ranks = num_ranks, .latency_s = kLatency}, barrier), steps * kLatency);
}

TEST(VirtualSeconds, ASumTakesItsBytesInEachStep) {
  const auto sum = [](Communication& ranks) {
    std::vector<std::uint64_t> values(5);
    ranks.sum(values);
  };
  expect_network_s(reports_of(sum), 2 * (kLatency + 40 * kSecondsOfByte));
}

TEST(VirtualSeconds, AGatherTakesTheBytesOfAll) {
  const std::vector<RankReport> reports = reports_of(
      [](Communication& ranks) { ranks.all_gather(Bytes(static_cast<std::size_t>(ranks.rank()))); });
  expect_network_s(reports, 4 * kLatency + (8 * 4 + 0 + 1 + 2 + 3) * kSecondsOfByte);
  EXPECT_EQ(reports[0].messages_sent, 0);
  EXPECT_EQ(reports[2].messages_sent, 3);
  EXPECT_EQ(reports[2].bytes_sent, 6);
}

// One rank sends 100 and 10 bytes, or receives them; its message to itself is free.
TEST(VirtualSeconds, AnExchangeTakesWhatTheBusiestRankSendsOrReceives) {
  const double lengths_s = 2 * (kLatency + 16 * kSecondsOfByte);
  const std::vector<RankReport> sending = reports_of([](Communication& ranks) {
    if (ranks.rank() == 2) {
      ranks.all_to_all({Bytes(100), Bytes(10), Bytes(5000), Bytes()});
    } else {
      ranks.all_to_all(std::vector<Bytes>(4));
    }
  });
  expect_network_s(sending, lengths_s + 2 * kLatency + 110 * kSecondsOfByte);
  EXPECT_EQ(sending[2].messages_sent, 2);
  EXPECT_EQ(sending[2].bytes_sent, 110);
  EXPECT_EQ(sending[0].messages_sent, 0);

  const std::vector<RankReport> receiving = reports_of([](Communication& ranks) {
    std::vector<Bytes> messages(4);
    if (ranks.rank() < 2) messages[3].resize(ranks.rank() == 0 ? 100 : 10);
    ranks.all_to_all(messages);
  });
  expect_network_s(receiving, lengths_s + 2 * kLatency + 110 * kSecondsOfByte);
}

TEST(VirtualSeconds, AllWaitForTheOneThatTakesLongest) {
  const std::vector<RankReport> reports =
      run_ranks({.num_ranks = 5, .latency_s = kLatency}, [](Communication& ranks) {
        const double charged_s = 1e5 * (1 + ranks.rank() * 3 % 5);  // most on rank 3
        ranks.charge(charged_s);
        EXPECT_NEAR(ranks.seconds(), charged_s, 100);
        ranks.barrier();
        EXPECT_NEAR(ranks.seconds(), 5e5 + 3 * kLatency, 100);
      });
  for (std::size_t i = 0; i < 5; ++i) {
    const double computing_s = 1e5 * static_cast<double>(1 + i * 3 % 5);
    EXPECT_NEAR(reports[i].computing_s, computing_s, 100);
    EXPECT_NEAR(reports[i].waiting_s, 5e5 - computing_s, 200);
    EXPECT_NEAR(reports[i].total_s(), 5e5 + 3 * kLatency, 100);
  }
}

// The clock measures processor time of the rank's own thread. It does not measure sleep, nor the work of
// other threads.
TEST(VirtualSeconds, TheClockIsTheRanksProcessorTime) {
  const double busy_s = 0.2;
  const std::vector<RankReport> reports = run_ranks({.num_ranks = 3}, [&](Communication& ranks) {
    ranks.barrier();
    const double start_s = processor_seconds();
    while (ranks.rank() == 1 && processor_seconds() - start_s < busy_s) {
    }
    if (ranks.rank() == 2) std::this_thread::sleep_for(std::chrono::duration<double>(busy_s));
    ranks.barrier();
  });
  EXPECT_GE(reports[1].computing_s, busy_s);
  EXPECT_LT(reports[0].computing_s, busy_s / 2);
  EXPECT_LT(reports[2].computing_s, busy_s / 2);
  EXPECT_GE(reports[2].waiting_s, busy_s / 2);
}

// Two ranks compute the same. One has four virtual threads and takes a quarter of the other's time.
TEST(VirtualSeconds, VirtualThreadsShareTheWorkOfLoops) {
  const double round_s = 0.02;
  const auto rounds_of = [&](std::size_t threads) {
    return run_ranks({.num_ranks = 2, .one_at_a_time = true, .has_virtual_threads = true},
                     [&](Communication& ranks) {
                       parallel_for(8, threads, [&](std::size_t, std::size_t) {
                         const double start_s = processor_seconds();
                         while (processor_seconds() - start_s < round_s) {
                         }
                       });
                       ranks.barrier();
                     });
  };
  const double alone_s = rounds_of(1)[1].computing_s, together_s = rounds_of(4)[1].computing_s;
  EXPECT_GE(alone_s, 8 * round_s);
  EXPECT_GE(together_s, 2 * round_s);
  EXPECT_LT(together_s, alone_s / 2);
}

}  // namespace
}  // namespace podm
