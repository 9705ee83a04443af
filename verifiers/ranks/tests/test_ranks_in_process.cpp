#include "ranks/ranks_in_process.h"

#include "ranks/tests/communication_cases.h"

namespace podm::verify {
namespace {

TEST(RanksInProcess, CommunicateLikeRanks) {
  for (const int num_ranks : {1, 2, 3, 5, 8})
    run_ranks(num_ranks, [&](Communication& ranks) {
      EXPECT_EQ(ranks.size(), num_ranks);
      for (int i = 0; i < 20; ++i) expect_all_of_communication(ranks);
    });
}

TEST(RanksInProcess, SingleRankCommunicatesWithItself) {
  SingleRank ranks;
  expect_all_of_communication(ranks);
}

TEST(RanksInProcess, ThrowWhatTheFirstFailedRankThrew) {
  const auto body = [](Communication& ranks) {
    if (ranks.rank() >= 1) throw std::logic_error("rank " + std::to_string(ranks.rank()));
    gather(ranks, 1);
    ADD_FAILURE() << "a collective without the other ranks returned";
  };
  try {
    run_ranks(3, body);
    ADD_FAILURE() << "no exception";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "rank 1");
  }
}

TEST(RanksInProcess, DoNotWaitForARankThatReturned) {
  std::size_t num_ended = 0;
  run_ranks(2, [&](Communication& ranks) {
    if (ranks.rank() == 0) return;
    EXPECT_THROW(gather(ranks, 1), RankFailed);
    ++num_ended;
  });
  EXPECT_EQ(num_ended, 1U);
}

struct Named {
  std::string name;
  std::map<int, std::vector<double>> values;

  template <class Stream>
  void transfer(Stream& stream) {
    stream(name, values);
  }
  bool operator==(const Named&) const = default;
};

TEST(ByteStream, ReturnsWhatWasWritten) {
  const std::vector<Named> written{{"a", {{1, {0.5, -0.0}}, {-7, {}}}}, {"", {}}};
  std::vector<Named> read(7);
  read_bytes(bytes_of(written), read);
  EXPECT_EQ(read, written);
}

TEST(ByteStream, RefusesBytesOfAnotherLength) {
  const Bytes bytes = bytes_of(std::vector<Named>{{"a", {{1, {0.5, -0.0}}, {-7, {}}}}, {"", {}}});
  std::vector<Named> read;
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(read_bytes({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}, read),
                 std::runtime_error);
  Bytes longer = bytes;
  longer.push_back({});
  EXPECT_THROW(read_bytes(longer, read), std::runtime_error);
  EXPECT_THROW(read_bytes(bytes_of(std::uint64_t{1} << 62), read), std::runtime_error);
}

}  // namespace
}  // namespace podm::verify
