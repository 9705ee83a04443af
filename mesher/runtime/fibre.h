// A call with its own stack that can stop in its middle and continue later, all on one thread.
#pragma once

#include <boost/context/fiber.hpp>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>

namespace podm {

class Fibre {
 public:
  enum class State { kEnded, kSuspended, kOutOfSteps };
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  /// Prepares a call, which the first resume() begins. It must not be destroyed before the call has ended.
  explicit Fibre(std::function<void()> call);
  ~Fibre();
  Fibre(const Fibre&) = delete;
  Fibre& operator=(const Fibre&) = delete;

  /// Lets the call continue until it suspends, ends or runs out of steps. Rethrows an exception of the call,
  /// which ends the call.
  State resume();
  State state() const { return state_; }

  /// Returns the fibre whose call is running; nullptr outside of any fibre.
  static Fibre* current();
  /// Stops the call here. Must not be called while the call handles an exception: exceptions that are being
  /// handled belong to the thread, and another fibre would get this one's.
  void suspend() { stop(State::kSuspended); }
  /// Stops the call at the given number of step() calls from now, at least one, or at the next where it may
  /// stop.
  void allow(std::uint64_t steps) { steps_left_ = steps; }
  bool is_limited() const { return steps_left_ < kUnlimited / 2; }
  void step() {
    if (--steps_left_ == 0) stop_out_of_steps();
  }

 private:
  struct Stacks;  // data for the sanitizers

  boost::context::fiber run(boost::context::fiber&& resumer);
  void stop(State state);
  void stop_out_of_steps();

  std::function<void()> call_;
  State state_ = State::kSuspended;
  std::uint64_t steps_left_ = kUnlimited;
  std::exception_ptr failure_;
  std::unique_ptr<Stacks> stacks_;
  const std::byte* bottom_ = nullptr;  // of this fibre's stack
  boost::context::fiber own_, resumer_;
};

}  // namespace podm
