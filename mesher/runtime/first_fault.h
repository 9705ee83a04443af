// The first exception of several threads, for the thread that started them.
#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace podm {

class FirstFault {
 public:
  /// Calls action(), unless a fault was noted before. Notes the exception that it throws, if any.
  template <class Action>
  void guard(const Action& action) {
    if (has_fault_.load(std::memory_order_relaxed)) return;  // a thread that sees it late only does more work
    try {
      action();
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!fault_) fault_ = std::current_exception();
      has_fault_.store(true, std::memory_order_relaxed);
    }
  }
  /// Throws the first exception, if there was one. The threads must have ended.
  void rethrow() const {
    if (fault_) std::rethrow_exception(fault_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr fault_;
  std::atomic<bool> has_fault_ = false;
};

}  // namespace podm
