// Owners of the pieces of a shared array: queried from a made-up machine of four nodes, and dealt for
// described machines.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "runtime/memory_owners.h"
#include "runtime/tests/machines.h"

namespace podm::test {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes per query

// Places page n of `array` on the node with the operating system's number n modulo 4.
template <class T>
PageQuery in_turn(const std::vector<T>& array) {
  return [&array](std::span<const void* const> addresses) {
    PageNodes nodes;
    for (const void* address : addresses) {
      const auto offset = static_cast<const char*>(address) - reinterpret_cast<const char*>(array.data());
      nodes.os_indices.push_back(static_cast<int>(static_cast<std::size_t>(offset) / kPiece % 4));
    }
    return nodes;
  };
}

template <class T>
void expect_asked_in_turn(std::size_t size) {
  const std::vector<T> array(size);
  const auto owners = MemoryOwners::ask(std::span(array), four_nodes(), in_turn(array));
  ASSERT_EQ(owners.unavailable(), "");
  EXPECT_EQ(owners.size(), size);
  for (std::size_t i = 0; i < size; ++i) {
    ASSERT_EQ(owners.node_of(i), i * sizeof(T) / kPiece % 4) << i;
    ASSERT_EQ(owners.address_of(i), &array[i]);
  }
}

TEST(MemoryOwners, AreAskedPieceByPiece) {
  for (const std::size_t size : {1u, 1000u, 32768u, 32769u, 200'000u}) {
    expect_asked_in_turn<std::uint16_t>(size);
    expect_asked_in_turn<std::uint32_t>(size);
  }
}

TEST(MemoryOwners, SayWhyTheyAreUnknown) {
  const std::vector<std::uint32_t> array(100'000);
  const auto ask = [&](const PageQuery& query) {
    return MemoryOwners::ask(std::span(array), four_nodes(), query).unavailable();
  };
  const auto answer = [](int os_index) {
    return [os_index](std::span<const void* const> addresses) {
      return PageNodes{std::vector<int>(addresses.size(), os_index), ""};
    };
  };
  EXPECT_EQ(ask(answer(3)), "");
  EXPECT_NE(ask(answer(4)).find("node 4"), std::string::npos) << "of another process's part of the machine";
  EXPECT_NE(ask(answer(PageNodes::kNowhere)), "");
  EXPECT_EQ(ask([](auto) { return PageNodes{{}, "forbidden here"}; }), "forbidden here");
}

TEST(MemoryOwners, AreDealtToAllWorkersAndTheSameForTheSameSeed) {
  const std::vector<std::uint32_t> array(1 << 20);
  constexpr unsigned kPieceBits = 12;
  const std::vector<NodeIndex> nodes{0, 0, 1, 3};  // per worker
  const auto deal = [&](std::uint64_t seed) {
    const auto owners = MemoryOwners::deal(std::span(array), kPieceBits, nodes, seed);
    std::vector<NodeIndex> dealt;
    for (std::size_t i = 0; i < array.size(); i += 256) dealt.push_back(owners.node_of(i));
    return dealt;
  };
  const std::vector<NodeIndex> first = deal(1);
  EXPECT_EQ(first, deal(1));
  EXPECT_NE(first, deal(2));
  EXPECT_EQ(std::set(first.begin(), first.end()), std::set(nodes.begin(), nodes.end()));
  for (std::size_t i = 0; i < first.size(); ++i)
    ASSERT_EQ(first[i], first[i / 4 * 4]) << "a piece is one node's";
  const auto on_node_0 = std::count(first.begin(), first.end(), 0);
  EXPECT_NEAR(static_cast<double>(on_node_0) / static_cast<double>(first.size()), 0.5, 0.1)
      << "half of the workers are there";
}

}  // namespace
}  // namespace podm::test
