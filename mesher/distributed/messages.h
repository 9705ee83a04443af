// Conversion of values to and from the bytes of a message. All ranks run the same program on machines of one
// kind, so values are sent in their memory layout.
#pragma once

#include <fmt/format.h>

#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "distributed/communication.h"

namespace podm {

/// Appends the number of the values, and the values.
template <class T>
void append(Bytes& message, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t count = values.size();
  const std::size_t before = message.size();
  message.resize(before + sizeof count + values.size_bytes());
  std::memcpy(message.data() + before, &count, sizeof count);
  if (count > 0) std::memcpy(message.data() + before + sizeof count, values.data(), values.size_bytes());
}

template <class T>
void append(Bytes& message, const std::vector<T>& values) {
  append(message, std::span<const T>(values));
}

/// Returns a message of each vector, in order. No values make an empty message.
template <class T>
std::vector<Bytes> messages_of(const std::vector<std::vector<T>>& values) {
  std::vector<Bytes> messages(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!values[i].empty()) append(messages[i], values[i]);
  return messages;
}

/// Reads the vectors of a message in the order in which they were appended. The message must outlive the
/// reader.
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> message) : rest_(message) {}

  /// Throws InternalError if the message ends before the values do.
  template <class T>
  std::vector<T> read() {
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint64_t count = 0;
    take(&count, 1, sizeof count);
    if (count > rest_.size() / sizeof(T)) throw_short(count, sizeof(T));
    std::vector<T> values(count);
    take(values.data(), count, sizeof(T));
    return values;
  }
  /// Throws InternalError unless the whole message has been read.
  void expect_end() const {
    if (!rest_.empty()) throw InternalError(fmt::format("{} bytes of a message are left over", rest_.size()));
  }

 private:
  [[noreturn]] void throw_short(std::uint64_t count, std::size_t value_bytes) const {
    throw InternalError(fmt::format("a message ends after {} bytes of {} values of {} bytes", rest_.size(),
                                    count, value_bytes));
  }
  void take(void* values, std::uint64_t count, std::size_t value_bytes) {
    if (count > rest_.size() / value_bytes) throw_short(count, value_bytes);
    if (count == 0) return;  // an empty vector may have no memory
    std::memcpy(values, rest_.data(), count * value_bytes);
    rest_ = rest_.subspan(count * value_bytes);
  }

  std::span<const std::byte> rest_;
};

/// Returns the values of a message of messages_of().
template <class T>
std::vector<T> values_of(const Bytes& message) {
  if (message.empty()) return {};
  MessageReader reader(message);
  std::vector<T> values = reader.read<T>();
  reader.expect_end();
  return values;
}

/// Collective. Sends values[i] to rank i. Returns what this rank receives, in the order of the ranks.
template <class T>
std::vector<T> exchanged(const std::vector<std::vector<T>>& values, Communication& ranks) {
  std::vector<T> here;
  for (const Bytes& received : ranks.all_to_all(messages_of(values))) {
    const std::vector<T> more = values_of<T>(received);
    here.insert(here.end(), more.begin(), more.end());
  }
  return here;
}

}  // namespace podm
