#include <gtest/gtest.h>

#include "distributed/messages.h"

namespace podm {
namespace {

struct Vertex {
  double x, y, z;
  std::uint32_t kind;
  bool operator==(const Vertex&) const = default;
};

TEST(Messages, VectorsComeBackInOrder) {
  const std::vector<Vertex> vertices{{1, 2, 3, 4}, {-0.5, 1e300, 0, 1}};
  const std::vector<std::uint8_t> kinds{7, 8, 9};
  Bytes message;
  append(message, vertices);
  append(message, std::vector<std::uint64_t>{});
  append(message, kinds);

  MessageReader reader(message);
  EXPECT_EQ(reader.read<Vertex>(), vertices);
  EXPECT_TRUE(reader.read<std::uint64_t>().empty());
  EXPECT_EQ(reader.read<std::uint8_t>(), kinds);
  EXPECT_NO_THROW(reader.expect_end());
}

TEST(Messages, NoReaderPassesTheEnd) {
  Bytes message;
  append(message, std::vector<std::uint32_t>{1, 2, 3});
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_THROW(MessageReader(std::span(message).first(size)).read<std::uint32_t>(), InternalError) << size;
  // The same number of values of a longer type.
  EXPECT_THROW(MessageReader(message).read<std::uint64_t>(), InternalError);
}

TEST(Messages, ACountBeyondMemoryIsNotBelieved) {
  Bytes message(8, std::byte{0xff});
  message.resize(64);
  EXPECT_THROW(MessageReader(message).read<std::uint64_t>(), InternalError);
  EXPECT_THROW(MessageReader(message).read<std::uint8_t>(), InternalError);
}

TEST(Messages, WhatIsLeftOverIsSeen) {
  Bytes message;
  append(message, std::vector<std::uint8_t>{1});
  message.push_back({});
  MessageReader reader(message);
  reader.read<std::uint8_t>();
  EXPECT_THROW(reader.expect_end(), InternalError);
}

}  // namespace
}  // namespace podm
