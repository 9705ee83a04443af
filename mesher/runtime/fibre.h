// A call on a stack of its own that can stop in its middle and go on later, all on one thread. Sanitizers
// know nothing of such stacks.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>

namespace podm {

class Fibre {
 public:
  Fibre() = default;
  Fibre(const Fibre&) = delete;
  Fibre& operator=(const Fibre&) = delete;

  /// Makes a call ready, which the first resume() begins. The last one has ended.
  void begin(std::function<void()> call);
  /// Lets the call go on until its step() has been called so many times, at least once. True: it has ended.
  /// Throws what the call throws; that ends it.
  bool resume(std::uint64_t steps);
  bool has_ended() const { return has_ended_; }

  /// Whose call makes this one; nullptr: no fibre's.
  static Fibre* current();
  /// The call itself says that it may stop here. While it handles an exception it does not: exceptions that
  /// are being handled belong to the thread, and another fibre would get this one's.
  void step() {
    if (--steps_left_ == 0 && !std::current_exception()) stop();
  }

 private:
  static void run();
  void stop();

  std::function<void()> call_;
  bool has_ended_ = true;
  std::uint64_t steps_left_ = 0;
  std::exception_ptr failure_;
  std::unique_ptr<std::byte[]> stack_;
  ucontext_t own_{}, resumer_{};
};

}  // namespace podm
