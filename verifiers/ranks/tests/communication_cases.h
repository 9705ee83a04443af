// The properties of every implementation of the communication.
#pragma once

#include <gtest/gtest.h>

#include <numeric>

#include "ranks/communication.h"
#include "ranks/tree_sum.h"

namespace podm::verify {

// Each rank sends each rank a list whose length and numbers state both ranks.
inline void expect_lists_to_arrive(Communication& ranks) {
  const auto own = static_cast<std::uint64_t>(ranks.rank());
  const auto list_from_to = [](std::uint64_t from, std::uint64_t to) {
    std::vector<std::uint64_t> list(from == to + 1 ? 0 : 3 * from + to);
    std::iota(list.begin(), list.end(), 1000 * from + to);
    return list;
  };
  std::vector<std::vector<std::uint64_t>> lists;
  for (int to = 0; to < ranks.size(); ++to)
    lists.push_back(list_from_to(own, static_cast<std::uint64_t>(to)));
  const auto received = exchange(ranks, lists);
  for (std::size_t from = 0; from < received.size(); ++from)
    EXPECT_EQ(received[from], list_from_to(from, own));
}

inline void expect_values_of_all(Communication& ranks) {
  const auto texts = gather(ranks, std::string(static_cast<std::size_t>(ranks.rank()), 'x'));
  for (std::size_t r = 0; r < texts.size(); ++r) EXPECT_EQ(texts[r], std::string(r, 'x'));
  const auto size = static_cast<std::uint64_t>(ranks.size());
  EXPECT_EQ(sum_over(ranks, static_cast<std::uint64_t>(ranks.rank())), size * (size - 1) / 2);
}

// The fault of one rank reaches all, and all can go on.
inline void expect_fault_of_all(Communication& ranks) {
  for (int faulty = 0; faulty < ranks.size(); ++faulty) {
    try {
      do_on_all(ranks, [&] {
        if (ranks.rank() >= faulty) throw InputError("fault of " + std::to_string(ranks.rank()));
      });
      ADD_FAILURE() << "no fault on rank " << ranks.rank();
    } catch (const RefusedByAll& error) {
      EXPECT_EQ(error.what(), "fault of " + std::to_string(faulty));
    }
  }
}

inline void expect_refusal_of_other_facts(Communication& ranks) {
  expect_agreement(ranks, {{"a", "same"}, {"b", ""}});
  for (int other = 1; other < ranks.size(); ++other) {
    try {
      expect_agreement(ranks, {{"a", "same"}, {"b", ranks.rank() >= other ? "new" : "old"}});
      ADD_FAILURE() << "no refusal on rank " << ranks.rank();
    } catch (const RefusedByAll& error) {
      EXPECT_EQ(error.what(), "rank " + std::to_string(other) + " of " + std::to_string(ranks.size()) +
                                  " does not have the b of rank 0: new, not old");
    }
  }
}

struct Joined {
  std::string text;
  void add(const Joined& other) { text += other.text; }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(text);
  }
};
inline void expect_sum_in_the_order_of_ranks(Communication& ranks) {
  std::string expected;
  for (int r = 0; r < ranks.size(); ++r) expected += std::to_string(r) + ' ';
  EXPECT_EQ(tree_sum(ranks, Joined{std::to_string(ranks.rank()) + ' '}).text, expected);
}

inline void expect_all_of_communication(Communication& ranks) {
  expect_lists_to_arrive(ranks);
  expect_values_of_all(ranks);
  expect_sum_in_the_order_of_ranks(ranks);
  expect_fault_of_all(ranks);
  expect_refusal_of_other_facts(ranks);
}

}  // namespace podm::verify
