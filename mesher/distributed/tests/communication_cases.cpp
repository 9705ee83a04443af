#include "communication_cases.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <functional>
#include <random>
#include <thread>

#include "distributed/messages.h"

namespace podm::test {
namespace {

Bytes random_bytes(std::mt19937_64& random, std::size_t size) {
  Bytes bytes;
  while (bytes.size() < size) {
    const std::uint64_t word = random();
    const auto word_bytes = std::as_bytes(std::span(&word, 1));
    bytes.insert(bytes.end(), word_bytes.begin(), word_bytes.end());
  }
  bytes.resize(size);
  return bytes;
}

std::mt19937_64 random_of(std::uint64_t seed, int step, int from, int to) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(step),
                         static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(to)};
  return std::mt19937_64(sequence);
}

// Returns the message of a collective, given by its number, from one rank to another: often empty, rarely
// long.
Bytes message_of(std::uint64_t seed, int step, int from, int to) {
  std::mt19937_64 random = random_of(seed, step, from, to);
  constexpr std::array<std::size_t, 5> kMostBytes{0, 1, 9, 300, 20'000};
  return random_bytes(random, random() % (kMostBytes[random() % kMostBytes.size()] + 1));
}

std::vector<std::uint64_t> values_of(std::uint64_t seed, int step, int rank, std::size_t count) {
  std::mt19937_64 random = random_of(seed, step, rank, -1);
  std::vector<std::uint64_t> values(count);
  for (std::uint64_t& value : values) value = random();
  return values;
}

void expect_all_to_all(Communication& communication, std::uint64_t seed, int step) {
  const int self = communication.rank();
  std::vector<Bytes> messages;
  for (int to = 0; to < communication.size(); ++to) messages.push_back(message_of(seed, step, self, to));
  const std::vector<Bytes> received = communication.all_to_all(std::move(messages));
  ASSERT_EQ(received.size(), static_cast<std::size_t>(communication.size()));
  for (int from = 0; from < communication.size(); ++from)
    EXPECT_TRUE(received[static_cast<std::size_t>(from)] == message_of(seed, step, from, self))
        << from << " to " << self;
}

void expect_all_gather(Communication& communication, std::uint64_t seed, int step) {
  const std::vector<Bytes> all = communication.all_gather(message_of(seed, step, communication.rank(), -1));
  ASSERT_EQ(all.size(), static_cast<std::size_t>(communication.size()));
  for (int from = 0; from < communication.size(); ++from)
    EXPECT_TRUE(all[static_cast<std::size_t>(from)] == message_of(seed, step, from, -1)) << from;
}

template <class Combine>
std::vector<std::uint64_t> combined(const Communication& communication, std::uint64_t seed, int step,
                                    std::size_t count, const Combine& combine) {
  std::vector<std::uint64_t> all = values_of(seed, step, 0, count);
  for (int rank = 1; rank < communication.size(); ++rank) {
    const std::vector<std::uint64_t> values = values_of(seed, step, rank, count);
    for (std::size_t i = 0; i < count; ++i) all[i] = combine(all[i], values[i]);
  }
  return all;
}

}  // namespace

void expect_random_collectives(Communication& communication, std::uint64_t seed, int num_collectives) {
  std::mt19937_64 random(seed);  // the same on all ranks
  for (int step = 0; step < num_collectives; ++step) {
    const std::uint64_t collective = random() % 5;
    const std::size_t count = random() % 40;
    std::vector<std::uint64_t> values = values_of(seed, step, communication.rank(), count);
    if (collective == 0) {
      expect_all_to_all(communication, seed, step);
    } else if (collective == 1) {
      expect_all_gather(communication, seed, step);
    } else if (collective == 2) {
      communication.sum(values);
      EXPECT_EQ(values, combined(communication, seed, step, count, std::plus<>()));
    } else if (collective == 3) {
      communication.maximum(values);
      EXPECT_EQ(values, combined(communication, seed, step, count,
                                 [](std::uint64_t a, std::uint64_t b) { return std::max(a, b); }));
    } else {
      communication.barrier();
    }
  }
}

void expect_lengths(Communication& communication, std::size_t most_bytes) {
  const int self = communication.rank(), size = communication.size();
  const std::vector<std::size_t> lengths{
      0, 1, most_bytes - 1, most_bytes, most_bytes + 1, 3 * most_bytes + 7};
  const auto bytes_from = [&](int from, int to) {
    std::mt19937_64 random = random_of(1, 2, from, to);
    return random_bytes(random, lengths[static_cast<std::size_t>(from + to) % lengths.size()]);
  };
  for (int shift = 0; shift < static_cast<int>(lengths.size()); ++shift) {
    std::vector<Bytes> messages;
    for (int to = 0; to < size; ++to) messages.push_back(bytes_from(self, to + shift));
    const std::vector<Bytes> received = communication.all_to_all(messages);
    const std::vector<Bytes> gathered = communication.all_gather(bytes_from(self, shift));
    for (int from = 0; from < size; ++from) {
      EXPECT_TRUE(received[static_cast<std::size_t>(from)] == bytes_from(from, self + shift));
      EXPECT_TRUE(gathered[static_cast<std::size_t>(from)] == bytes_from(from, shift));
    }
  }
  std::vector<std::uint64_t> values(most_bytes / 4 + 3, static_cast<std::uint64_t>(self));
  communication.sum(values);
  EXPECT_EQ(values,
            std::vector<std::uint64_t>(values.size(), static_cast<std::uint64_t>(size * (size - 1) / 2)));
}

void expect_one_message_per_rank(Communication& communication) {
  const auto size = static_cast<std::size_t>(communication.size());
  EXPECT_THROW(communication.all_to_all(std::vector<Bytes>(size - 1)), InternalError);
  EXPECT_THROW(communication.all_to_all(std::vector<Bytes>(size + 1)), InternalError);
}

void expect_barrier(Communication& communication) {
  using Clock = std::chrono::steady_clock;  // one clock for all processes of a machine
  std::mt19937_64 random = random_of(3, 4, communication.rank(), 0);
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 3000));
    const std::vector<std::int64_t> came{Clock::now().time_since_epoch().count()};
    communication.barrier();
    const std::int64_t went = Clock::now().time_since_epoch().count();
    Bytes message;
    append(message, came);
    for (const Bytes& other : communication.all_gather(message))
      EXPECT_LE(MessageReader(other).read<std::int64_t>().front(), went);
  }
}

void expect_announcements(Communication& communication, bool with_collectives) {
  using Clock = std::chrono::steady_clock;
  const int self = communication.rank(), last = communication.size() - 1;
  const auto expect_heard = [&](std::uint64_t value) {
    if (with_collectives) communication.barrier();
    const auto deadline = Clock::now() + std::chrono::seconds(20);
    while (communication.announced() < value && Clock::now() < deadline) std::this_thread::yield();
    EXPECT_EQ(communication.announced(), value);
    communication.barrier();  // until here no rank announces more
  };
  expect_heard(0);
  if (self == last) communication.announce(7);
  expect_heard(7);
  if (self == 0) communication.announce(3);
  expect_heard(7);
  communication.announce(static_cast<std::uint64_t>(10 + self));
  expect_heard(static_cast<std::uint64_t>(10 + last));
  if (self == 0) communication.announce(100);
}

}  // namespace podm::test
