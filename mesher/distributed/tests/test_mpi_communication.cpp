// The test cases over MPI, all on each process of a run. With `--throw-on-rank R` rank R throws instead,
// while the other ranks wait.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "communication_cases.h"
#include "distributed/end_on_all_ranks.h"
#include "distributed/mpi_communication.h"
#include "distributed/rank_failure.h"

namespace podm::test {
namespace {

TEST(MpiCommunication, CarriesRandomCollectives) {
  const auto communication = mpi_communication();
  for (std::uint64_t seed = 0; seed < 2; ++seed) expect_random_collectives(*communication, seed, 30);
}

TEST(MpiCommunication, CarriesWhatNoOneCallTakes) {
  const auto tiny = mpi_communication(16), small = mpi_communication(1000);
  expect_lengths(*tiny, 16);
  expect_random_collectives(*small, 7, 20);
}

TEST(MpiCommunication, WantsOneMessagePerRank) { expect_one_message_per_rank(*mpi_communication()); }

TEST(MpiCommunication, NoRankLeavesABarrierBeforeAllHaveCome) { expect_barrier(*mpi_communication()); }

TEST(MpiCommunication, AllRanksHearTheLargestAnnouncement) {
  for (int i = 0; i < 3; ++i) expect_announcements(*mpi_communication(), false);
}

// The other ranks come to the collective after they have heard of the end.
TEST(MpiCommunication, ARankThatWaitsAnnouncesTheEnd) {
  const auto communication = mpi_communication();
  const std::function<void()> collectives[] = {
      [&] { communication->barrier(); },
      [&] { communication->all_gather(Bytes(1)); },
      [&] { communication->all_to_all(std::vector<Bytes>(static_cast<std::size_t>(communication->size()))); },
      [&] {
        std::array<std::uint64_t, 1> one{1};
        communication->sum(one);
      },
  };
  for (const auto& collective : collectives) {
    std::stop_source stop;
    EndOnAllRanks end(*communication, stop.get_token());
    if (communication->rank() == communication->size() - 1) {
      stop.request_stop();
    } else {
      const double start_s = communication->seconds();
      while (!end.token().stop_requested() && communication->seconds() < start_s + 20) end.hear();
      EXPECT_TRUE(end.token().stop_requested());
    }
    collective();
  }
}

TEST(MpiCommunication, ItsClockGoesOn) {
  const auto communication = mpi_communication();
  const double start_s = communication->seconds();
  while (communication->seconds() == start_s) {
  }
  EXPECT_GT(communication->seconds(), start_s);
}

// MPI keeps the processor busy while a rank waits.
TEST(MpiCommunication, WaitingIsNoComputing) {
  const auto communication = mpi_communication();
  const int last = communication->size() - 1;
  communication->barrier();
  const RankReport before = communication->report();
  const double busy_s = 0.3;
  while (communication->rank() == last && communication->report().computing_s - before.computing_s < busy_s) {
  }
  communication->all_gather(Bytes(10));
  const RankReport after = communication->report();
  const double computing_s = after.computing_s - before.computing_s;
  if (communication->rank() == last) {
    EXPECT_GE(computing_s, busy_s);
  } else {
    EXPECT_LT(computing_s, busy_s / 2);
    EXPECT_GE(after.waiting_s - before.waiting_s, busy_s / 2);
  }
  EXPECT_EQ(after.bytes_sent - before.bytes_sent, 10 * static_cast<std::uint64_t>(last));
}

void throw_on_rank(int rank) {
  const auto communication = mpi_communication();
  if (communication->rank() == rank) throw InputError("planted");
  communication->barrier();
}

}  // namespace
}  // namespace podm::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::GTEST_FLAG(catch_exceptions) = false;  // the other ranks wait for this rank
  const podm::MpiSession session(argc, argv);
  const auto communication = podm::mpi_communication();
  try {
    if (argc == 3 && std::string_view(argv[1]) == "--throw-on-rank")
      podm::test::throw_on_rank(std::stoi(argv[2]));
    return RUN_ALL_TESTS();
  } catch (...) {
    try {
      std::rethrow_exception(
          podm::current_rank_failure(communication->rank(), communication->size()).exception);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      podm::abort_all_ranks(2);
    }
  }
}
