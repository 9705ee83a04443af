// The communication between the ranks of a run: one collective with several implementations
// (ranks_in_process.h, ranks_over_mpi.h), and the collectives that rest on it. All ranks call the same
// collectives in the same order, also ranks without cells.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "errors.h"
#include "ranks/byte_stream.h"

namespace podm::verify {

class Communication {
 public:
  virtual ~Communication() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Sends one message to each rank, and returns the message of each rank to this rank, both by rank.
  virtual std::vector<Bytes> all_to_all(std::vector<Bytes> messages) = 0;
};

/// The communication of a run without other ranks.
class SingleRank final : public Communication {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override { return messages; }
};

/// Another rank failed, so this rank ends although it has no fault.
class RankFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// All ranks throw it with the same text, so one rank may report it and no rank waits for another.
class RefusedByAll : public InputError {
 public:
  using InputError::InputError;
};

/// Returns the value of each rank, by rank.
template <class Value>
std::vector<Value> gather(Communication& ranks, const Value& value) {
  const auto size = static_cast<std::size_t>(ranks.size());
  std::vector<Value> values(size);
  const std::vector<Bytes> received = ranks.all_to_all(std::vector<Bytes>(size, bytes_of(value)));
  for (std::size_t r = 0; r < size; ++r) read_bytes(received[r], values[r]);
  return values;
}

/// Sends one list to each rank, and returns the list of each rank to this rank, both by rank.
template <class Item>
std::vector<std::vector<Item>> exchange(Communication& ranks, std::vector<std::vector<Item>> lists) {
  const auto own = static_cast<std::size_t>(ranks.rank());
  std::vector<Bytes> messages(lists.size());
  for (std::size_t r = 0; r < lists.size(); ++r)
    if (r != own && !lists[r].empty()) messages[r] = bytes_of(std::exchange(lists[r], {}));
  messages = ranks.all_to_all(std::move(messages));
  for (std::size_t r = 0; r < lists.size(); ++r)
    if (r != own && !messages[r].empty()) read_bytes(std::exchange(messages[r], {}), lists[r]);
  return lists;
}

/// Like exchange(), but returns the lists of all ranks as one, in the order of ranks.
template <class Item>
std::vector<Item> exchange_joined(Communication& ranks, std::vector<std::vector<Item>> lists) {
  lists = exchange(ranks, std::move(lists));
  std::vector<Item> all = std::move(lists[0]);
  for (std::size_t r = 1; r < lists.size(); ++r) all.insert(all.end(), lists[r].begin(), lists[r].end());
  return all;
}

/// Return the sum over all ranks: of a value, and of each value of vectors of one size.
std::uint64_t sum_over(Communication& ranks, std::uint64_t value);
template <class Value>
std::vector<Value> sum_over(Communication& ranks, const std::vector<Value>& values) {
  std::vector<Value> sums(values.size());
  for (const std::vector<Value>& part : gather(ranks, values))
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += part[i];
  return sums;
}

/// Calls action(), which must not be collective. Throws RefusedByAll on all ranks if action() threw
/// InputError on any; the text is that of the first such rank.
void do_on_all(Communication& ranks, const std::function<void()>& action);

/// A name, and the text that all ranks must have for it.
using Fact = std::pair<std::string, std::string>;
/// Throws RefusedByAll if the ranks differ, naming the first that differs from rank 0 and its first such
/// fact. All ranks pass facts of the same names.
void expect_agreement(Communication& ranks, const std::vector<Fact>& facts);

}  // namespace podm::verify
