// The order of the processes within a round.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace podm::bench {

/// Draws an order for each odd round and reverses it for the even round after it. Each process then runs
/// before any other process as often as after it, and neither a steady drift nor the position in the round
/// favours a process.
class DrawnOrder {
 public:
  DrawnOrder(std::size_t num_processes, std::uint64_t seed) : random_(seed), order_(num_processes) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  /// Returns the processes of the next round, by number.
  const std::vector<std::size_t>& next() {
    if (is_drawn_)
      std::reverse(order_.begin(), order_.end());
    else
      std::shuffle(order_.begin(), order_.end(), random_);
    is_drawn_ = !is_drawn_;
    return order_;
  }

 private:
  std::mt19937_64 random_;
  std::vector<std::size_t> order_;
  bool is_drawn_ = false;  // the last order was drawn; the next one is its reverse
};

}  // namespace podm::bench
