// Ends a run on all ranks within a second after it has ended on one.
//
// A rank whose work ends at the limit of time, by a signal or by a lack of memory announces it when its
// workers have stopped. A rank that has made its share of the limit of cells does not, so that the others
// make theirs. The other ranks hear of it while their workers are still at work: StopControl::observe() calls
// hear() a few times per second, on the thread that called the run. This is the only thread that may use
// Communication. No worker waits for it. A signal may also reach a rank that has ended its work and waits in
// a collective; it announces the end from there.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <utility>

#include "distributed/communication.h"

namespace podm {

class EndOnAllRanks {
 public:
  /// Collective. A request of `stop` ends the run, too.
  EndOnAllRanks(Communication& ranks, std::stop_token stop)
      : ranks_(ranks), on_stop_(std::move(stop), [this] { over_.request_stop(); }) {
    std::array<std::uint64_t, 1> before{ranks.announced()};
    ranks.maximum(before);
    before_ = before[0];
    ranks.look_while_waiting([this] { over_.stop_requested() ? announce() : hear(); });
  }
  ~EndOnAllRanks() { ranks_.look_while_waiting({}); }
  EndOnAllRanks(const EndOnAllRanks&) = delete;
  EndOnAllRanks& operator=(const EndOnAllRanks&) = delete;

  /// A stop is requested of this token when the run has to end on this rank.
  std::stop_token token() const { return over_.get_token(); }
  /// Announces that the run has ended on this rank, unless the rank has heard it from another.
  void announce() {
    hear();
    if (!is_known_) ranks_.announce(before_ + 1);
    is_known_ = true;
  }
  /// Ends the run if another rank has announced its end.
  void hear() {
    if (is_known_ || ranks_.announced() <= before_) return;
    is_known_ = true;
    over_.request_stop();
  }

 private:
  Communication& ranks_;
  std::uint64_t before_ = 0;  // the largest value that earlier runs on these ranks have announced
  bool is_known_ = false;     // that the run has ended on a rank
  std::stop_source over_;
  std::stop_callback<std::function<void()>> on_stop_;  // last: it may be called while it is constructed
};

}  // namespace podm
