#include "runtime/fibre.h"

#include <boost/context/protected_fixedsize_stack.hpp>
#include <utility>

#if defined(__SANITIZE_ADDRESS__)
#define PODM_TELLS_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PODM_TELLS_ADDRESS_SANITIZER
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define PODM_TELLS_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PODM_TELLS_THREAD_SANITIZER
#endif
#endif

#ifdef PODM_TELLS_ADDRESS_SANITIZER
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif
#ifdef PODM_TELLS_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace podm {

namespace {

// A call that needs more reaches the guard page behind the stack.
constexpr std::size_t kStackBytes = 256 << 10;

thread_local Fibre* running = nullptr;

// The last frames of a stack never return. The address sanitizer would take their marks for those of whatever
// is mapped at these addresses later.
class StackAllocator {
 public:
  boost::context::stack_context allocate() { return stacks_.allocate(); }
  void deallocate(boost::context::stack_context& stack) noexcept {
#ifdef PODM_TELLS_ADDRESS_SANITIZER
    __asan_unpoison_memory_region(static_cast<const std::byte*>(stack.sp) - kStackBytes, kStackBytes);
#endif
    stacks_.deallocate(stack);
  }

 private:
  boost::context::protected_fixedsize_stack stacks_{kStackBytes};
};

}  // namespace

// Sanitizers must be notified of every change of stacks. They call a stack that was left a fake one.
struct Fibre::Stacks {
#ifdef PODM_TELLS_ADDRESS_SANITIZER
  void* own_fake = nullptr;
  void* resumers_fake = nullptr;
  const void* resumers_bottom = nullptr;
  std::size_t resumers_bytes = 0;
  void enter(const void* bottom) { __sanitizer_start_switch_fiber(&resumers_fake, bottom, kStackBytes); }
  void entered() { __sanitizer_finish_switch_fiber(own_fake, &resumers_bottom, &resumers_bytes); }
  void leave(bool for_ever) {
    __sanitizer_start_switch_fiber(for_ever ? nullptr : &own_fake, resumers_bottom, resumers_bytes);
  }
  void left() { __sanitizer_finish_switch_fiber(resumers_fake, nullptr, nullptr); }
#elif defined(PODM_TELLS_THREAD_SANITIZER)
  void* own = __tsan_create_fiber(0);
  void* resumers = nullptr;
  ~Stacks() { __tsan_destroy_fiber(own); }
  void enter(const void*) {
    resumers = __tsan_get_current_fiber();
    __tsan_switch_to_fiber(own, 0);
  }
  void entered() {}
  void leave(bool) { __tsan_switch_to_fiber(resumers, 0); }
  void left() {}
#else
  void enter(const void*) {}
  void entered() {}
  void leave(bool) {}
  void left() {}
#endif
};

Fibre* Fibre::current() { return running; }

Fibre::Fibre(std::function<void()> call) : call_(std::move(call)), stacks_(std::make_unique<Stacks>()) {
  StackAllocator allocator;
  const boost::context::stack_context stack = allocator.allocate();
  bottom_ = static_cast<const std::byte*>(stack.sp) - kStackBytes;
  own_ = boost::context::fiber(std::allocator_arg, boost::context::preallocated(stack.sp, stack.size, stack),
                               allocator,
                               [this](boost::context::fiber&& resumer) { return run(std::move(resumer)); });
}

Fibre::~Fibre() = default;

Fibre::State Fibre::resume() {
  Fibre* const outer = std::exchange(running, this);
  stacks_->enter(bottom_);
  own_ = std::move(own_).resume();
  stacks_->left();
  running = outer;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return state_;
}

// The bottom of the stack: no exception may pass it.
boost::context::fiber Fibre::run(boost::context::fiber&& resumer) {
  stacks_->entered();
  resumer_ = std::move(resumer);
  try {
    call_();
  } catch (...) {
    failure_ = std::current_exception();
  }
  state_ = State::kEnded;
  stacks_->leave(true);
  return std::move(resumer_);
}

void Fibre::stop(State state) {
  state_ = state;
  stacks_->leave(false);
  resumer_ = std::move(resumer_).resume();
  stacks_->entered();
}

void Fibre::stop_out_of_steps() {
  if (std::current_exception()) {
    steps_left_ = 1;
  } else {
    stop(State::kOutOfSteps);
  }
}

}  // namespace podm
