#include "workers/real_time.h"

#include <boost/thread/scoped_thread.hpp>
#include <new>
#include <thread>

namespace podm {

RealTime::RealTime(StopControl& stop, std::size_t num_workers, std::vector<Place> places)
    : stop_(stop), places_(std::move(places)), states_(num_workers), on_over_(stop.over(), [this] {
        for (WorkerState& state : states_) state.resumed.release();
      }) {}

void RealTime::run(const std::function<void(WorkerId)>& work) {
  const auto start = Clock::now();
  {
    std::vector<boost::scoped_thread<>> threads;
    try {
      threads.reserve(states_.size());
      for (WorkerId self = 1; self < states_.size(); ++self)
        threads.emplace_back([&, self] { work_on_thread(work, self); });
    } catch (const std::bad_alloc&) {  // threads that already run end now
      stop_.end(StopReason::kMemoryLimit);
    } catch (...) {  // a thread could not be started
      fail();
    }
    start_s_ += seconds_since(start);
    work_on_thread(work, 0);
  }
  if (failure_) std::rethrow_exception(failure_);
}

void RealTime::work_on_thread(const std::function<void(WorkerId)>& work, WorkerId self) try {
  const ScopedBinding binding(places_.empty() ? std::nullopt : places_[self].processor);
  states_[self].processor = processor_of_this_thread();
  work(self);
} catch (const std::bad_alloc&) {
  stop_.end(StopReason::kMemoryLimit);
} catch (...) {
  fail();
}

// Ends the run with the exception that is being handled.
void RealTime::fail() {
  {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
  }
  stop_.end(StopReason::kCancelled);
}

void RealTime::block(WorkerId self, double Overhead::*cause) {
  const auto start = Clock::now();
  std::counting_semaphore<>& resumed = states_[self].resumed;
  if (self != 0) {
    if (!is_over()) resumed.acquire();
  } else {  // it goes on observing, because no other thread may, and the wait may take seconds
    constexpr auto kLongest = std::chrono::milliseconds(100);
    while (!is_over() && !resumed.try_acquire_for(kLongest)) stop_.observe();
  }
  states_[self].overhead.*cause += seconds_since(start);
  stop_.check_limits();  // the wait took the time of thousands of attempts
}

void RealTime::pause(WorkerId self, double seconds) {
  const auto start = Clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  states_[self].overhead.contention_s += seconds_since(start);
  stop_.check_limits();
}

}  // namespace podm
