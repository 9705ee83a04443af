// The sum over ranks of values that are too large for a rank to hold those of all.
#pragma once

#include "ranks/communication.h"

namespace podm::verify {

/// Collective. Returns the sum of the ranks' values by add(), in the order of ranks and the same on all. The
/// values are added along a binary tree, whose root is rank 0, and the sum returns along it.
template <class Sum>
Sum tree_sum(Communication& ranks, Sum own) {
  const auto rank = static_cast<std::size_t>(ranks.rank()), size = static_cast<std::size_t>(ranks.size());
  // Returns the message of `from`. The ranks that neither send nor receive have from = to = size.
  const auto pass = [&](std::size_t to, std::size_t from) {
    std::vector<Bytes> messages(size);
    if (to < size) messages[to] = bytes_of(own);
    messages = ranks.all_to_all(std::move(messages));
    return from < size ? std::move(messages[from]) : Bytes{};
  };
  std::size_t step = 1;
  for (; step < size; step *= 2) {
    const bool is_parent = rank % (2 * step) == 0 && rank + step < size, is_child = rank % (2 * step) == step;
    const Bytes received = pass(is_child ? rank - step : size, is_parent ? rank + step : size);
    if (!is_parent) continue;
    Sum other;
    read_bytes(received, other);
    own.add(other);
  }
  for (step /= 2; step > 0; step /= 2) {
    const bool is_parent = rank % (2 * step) == 0 && rank + step < size, is_child = rank % (2 * step) == step;
    const Bytes received = pass(is_parent ? rank + step : size, is_child ? rank - step : size);
    if (is_child) read_bytes(received, own);
  }
  return own;
}

}  // namespace podm::verify
