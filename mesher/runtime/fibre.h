// A call on a stack of its own that can stop in its middle and go on later, all on one thread.
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

  /// Makes a call ready, which the first resume() begins. It must not be destroyed before the call has ended.
  explicit Fibre(std::function<void()> call);
  ~Fibre();
  Fibre(const Fibre&) = delete;
  Fibre& operator=(const Fibre&) = delete;

  /// Lets the call go on until it suspends, ends, or is out of steps. Throws what the call throws; that ends
  /// it.
  State resume();
  State state() const { return state_; }

  /// Whose call makes this one; nullptr: no fibre's.
  static Fibre* current();
  /// The call stops here. Not while it handles an exception: those that are being handled belong to the
  /// thread, and another fibre would get this one's.
  void suspend() { stop(State::kSuspended); }
  /// So many calls of step() from now, at least one, the call stops there, or where it may next.
  void allow(std::uint64_t steps) { steps_left_ = steps; }
  bool is_limited() const { return steps_left_ < kUnlimited / 2; }
  void step() {
    if (--steps_left_ == 0) stop_out_of_steps();
  }

 private:
  struct Stacks;  // what sanitizers are told

  boost::context::fiber run(boost::context::fiber&& resumer);
  void stop(State state);
  void stop_out_of_steps();

  std::function<void()> call_;
  State state_ = State::kSuspended;
  std::uint64_t steps_left_ = kUnlimited;
  std::exception_ptr failure_;
  std::unique_ptr<Stacks> stacks_;
  const std::byte* bottom_ = nullptr;  // of its stack
  boost::context::fiber own_, resumer_;
};

}  // namespace podm
