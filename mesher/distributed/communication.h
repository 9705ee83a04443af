// The communication between ranks. The interface is small because it has two implementations
// (in_process_ranks.h, mpi_communication.h). Every function except announcements and those of the clock is
// collective: all ranks call the same functions in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "podm/errors.h"

namespace podm {

using Bytes = std::vector<std::byte>;

/// Another rank failed, so this rank ends although it has no fault. what() names the failed rank and its
/// fault. An implementation that ends all processes of a run at once never throws it.
class RankFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The seconds that a rank has spent until now, and what it has sent to other ranks. Up to the last
/// collective, the virtual seconds add up to the same sum on all ranks.
struct RankReport {
  double computing_s = 0;  ///< processor time outside collectives
  double waiting_s = 0;    ///< waiting time for ranks that took longer
  double network_s = 0;    ///< network time; a rank without a virtual clock counts it as waiting
  std::uint64_t messages_sent = 0, bytes_sent = 0;

  double total_s() const { return computing_s + waiting_s + network_s; }
};

class Communication {
 public:
  virtual ~Communication() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends a message to each rank, and returns the message of each rank to this rank, both by rank. An empty
  /// message costs only its size. Throws InternalError unless there is one message per rank.
  virtual std::vector<Bytes> all_to_all(std::vector<Bytes> messages) = 0;
  /// Returns the messages of all ranks, by rank.
  virtual std::vector<Bytes> all_gather(Bytes message) = 0;
  /// Replaces each value by its sum, or its maximum, over all ranks. All ranks pass the same number of
  /// values.
  virtual void sum(std::span<std::uint64_t> values) = 0;
  virtual void maximum(std::span<std::uint64_t> values) = 0;
  /// Returns when all ranks have called it.
  virtual void barrier() = 0;

  /// Announces a value to all ranks. Waits for no rank.
  virtual void announce(std::uint64_t value) = 0;
  /// Returns the largest value that has been announced by this rank or has reached it; 0 if there is none.
  virtual std::uint64_t announced() = 0;

  /// From now on calls look() now and then while this rank waits in a collective that other ranks have not
  /// called yet, on the thread that waits; an empty function: nothing. look() may only use announcements.
  /// Ranks of one process never call it, because a signal reaches all of them.
  virtual void look_while_waiting(std::function<void()> /*look*/) {}

  /// Returns this rank's clock, in seconds since an arbitrary moment: wall time or virtual time.
  virtual double seconds() const = 0;
  virtual bool is_virtual() const { return false; }
  virtual RankReport report() const = 0;
  /// Advances a virtual clock by the time that other threads of the rank took; the clock only measures the
  /// rank's own thread.
  virtual void charge(double /*seconds*/) {}

 protected:
  void check_one_per_rank(const std::vector<Bytes>& messages) const {
    if (messages.size() != static_cast<std::size_t>(size()))
      throw InternalError(std::to_string(messages.size()) + " messages for " + std::to_string(size()) +
                          " ranks");
  }
};

}  // namespace podm
