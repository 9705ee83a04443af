#include "runtime/fibre.h"

#include <utility>

namespace podm {

namespace {

constexpr std::size_t kStackBytes = 256 << 10;

thread_local Fibre* running = nullptr;

}  // namespace

Fibre* Fibre::current() { return running; }

void Fibre::begin(std::function<void()> call) {
  if (!stack_) stack_ = std::make_unique_for_overwrite<std::byte[]>(kStackBytes);
  call_ = std::move(call);
  getcontext(&own_);
  own_.uc_stack.ss_sp = stack_.get();
  own_.uc_stack.ss_size = kStackBytes;
  own_.uc_link = &resumer_;
  makecontext(&own_, &Fibre::run, 0);
  has_ended_ = false;
}

bool Fibre::resume(std::uint64_t steps) {
  steps_left_ = steps;
  Fibre* const outer = std::exchange(running, this);
  swapcontext(&resumer_, &own_);
  running = outer;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return has_ended_;
}

// The bottom of the stack: nothing may be thrown past it.
void Fibre::run() {
  Fibre& self = *running;
  try {
    self.call_();
  } catch (...) {
    self.failure_ = std::current_exception();
  }
  self.has_ended_ = true;
}

void Fibre::stop() { swapcontext(&own_, &resumer_); }

}  // namespace podm
