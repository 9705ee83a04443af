// The virtual threads of a rank in virtual time (distributed/in_process_ranks.h). All of them run on the
// rank's thread. Their clock takes the processor seconds of that thread, less the seconds that as many real
// threads save.
//
// A loop (parallel_for.h) runs its iterations one after the other and measures each. Each iteration goes to
// the virtual thread that is free first, as in a loop of real threads. The loop lasts until its last thread
// is free. Virtual threads neither meet each other's locks in a loop nor share a memory bus.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "runtime/processor_seconds.h"
#include "runtime/time_costs.h"

namespace podm {

class VirtualThreads {
 public:
  VirtualThreads() = default;
  VirtualThreads(const VirtualThreads&) = delete;
  VirtualThreads& operator=(const VirtualThreads&) = delete;

  /// Returns the virtual threads of the calling thread; null: its loops run on threads of the machine.
  static VirtualThreads* current() { return current_; }

  /// Calls work(i, thread) once for each i < count. A loop inside the loop runs on one virtual thread.
  template <class Work>
  void loop(std::size_t count, std::size_t threads, const Work& work) {
    if (is_in_loop_ || count == 0) {
      for (std::size_t i = 0; i < count; ++i) work(i, 0);
      return;
    }
    const InLoop in_loop(is_in_loop_);
    std::vector<double> free_at_s(std::clamp<std::size_t>(threads, 1, count));
    for (std::size_t t = 1; t < free_at_s.size(); ++t)
      free_at_s[t] = static_cast<double>(t) * TimeCosts().thread_started;
    const double start_s = processor_seconds();
    double now_s = start_s;
    for (std::size_t i = 0; i < count; ++i) {
      const auto first_free = std::min_element(free_at_s.begin(), free_at_s.end());
      work(i, static_cast<std::size_t>(first_free - free_at_s.begin()));
      const double before_s = std::exchange(now_s, processor_seconds());
      *first_free += now_s - before_s;
    }
    replace(now_s - start_s, *std::max_element(free_at_s.begin(), free_at_s.end()));
  }
  /// The virtual threads took `virtual_s` seconds for what the rank's thread did in `processor_s`.
  void replace(double processor_s, double virtual_s) { saved_s_ += processor_s - virtual_s; }
  /// Returns the seconds saved since the last call.
  double take_saved_s() { return std::exchange(saved_s_, 0); }

  /// Gives virtual threads to the calling thread, for its life.
  class Scope {
   public:
    explicit Scope(VirtualThreads& threads) { current_ = &threads; }
    ~Scope() { current_ = nullptr; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  };

 private:
  class InLoop {
   public:
    explicit InLoop(bool& is_in_loop) : is_in_loop_(is_in_loop) { is_in_loop_ = true; }
    ~InLoop() { is_in_loop_ = false; }

   private:
    bool& is_in_loop_;
  };

  static inline thread_local VirtualThreads* current_ = nullptr;
  double saved_s_ = 0;
  bool is_in_loop_ = false;
};

}  // namespace podm
