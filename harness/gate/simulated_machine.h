// A model of a shared machine. Simulations on it measure the error rates of the gate's answer about seconds.
#pragma once

#include <cstdint>
#include <random>

#include "gate/drawn_order.h"
#include "gate/gate_slowdown.h"

namespace podm::bench {

/// The speed wanders by a factor of 1.6 within an hour and jumps about every five minutes. Each process has
/// noise of its own, and one process in ten takes longer by a quarter on average.
class SimulatedMachine {
 public:
  /// `noise` is the standard deviation of the logarithm of a process's seconds.
  SimulatedMachine(std::uint64_t seed, double noise);

  /// Returns the seconds that a process takes now if it takes `seconds` on the average machine.
  double run(double seconds);
  /// Returns a base of one second, and a head that takes `head_over_base` times as long.
  Round round(double head_over_base);

 private:
  static constexpr double kWander = 0.12;  // two standard deviations on each side make a factor of 1.6

  double gauss() { return normal_(random_); }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  DrawnOrder order_;
  double noise_, wander_ = 0, jump_ = 0;  // of the logarithm of the seconds
};

}  // namespace podm::bench
