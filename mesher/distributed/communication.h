// What ranks say to each other: few words, so that there may be two who carry them (in_process_ranks.h,
// mpi_communication.h). Every function is collective, all ranks call the same ones in the same order, but for
// those about the clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "podm/errors.h"

namespace podm {

using Bytes = std::vector<std::byte>;

/// Another rank failed: this one ends, too, and is not at fault. what() names that rank and its fault.
/// Carriers that end all processes of a run at once never throw it.
class RankFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a rank has spent until now, in seconds, and sent to others. Virtual seconds of all ranks add up to
/// the same until the last collective.
struct RankReport {
  double computing_s = 0;  ///< of the processor, outside of collectives
  double waiting_s = 0;    ///< for ranks that took longer
  double network_s = 0;    ///< who has no virtual clock counts it as waiting
  std::uint64_t messages_sent = 0, bytes_sent = 0;

  double total_s() const { return computing_s + waiting_s + network_s; }
};

class Communication {
 public:
  virtual ~Communication() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends a message to each rank, and returns what each rank sent to this one, both by rank. Empty ones cost
  /// nothing but their size. Throws InternalError unless there is one message a rank.
  virtual std::vector<Bytes> all_to_all(std::vector<Bytes> messages) = 0;
  /// What every rank tells, by rank.
  virtual std::vector<Bytes> all_gather(Bytes message) = 0;
  /// Each value becomes its sum, or its maximum, over all ranks, which tell equally many.
  virtual void sum(std::span<std::uint64_t> values) = 0;
  virtual void maximum(std::span<std::uint64_t> values) = 0;
  /// Returns when all ranks have called it.
  virtual void barrier() = 0;

  /// This rank's clock, in seconds from some moment on: on the wall, or virtual.
  virtual double seconds() const = 0;
  virtual bool is_virtual() const { return false; }
  virtual RankReport report() const = 0;
  /// A virtual clock goes on by so much for what the rank had other threads do; it sees the rank's own thread
  /// alone.
  virtual void charge(double /*seconds*/) {}

 protected:
  void check_one_a_rank(const std::vector<Bytes>& messages) const {
    if (messages.size() != static_cast<std::size_t>(size()))
      throw InternalError(std::to_string(messages.size()) + " messages for " + std::to_string(size()) +
                          " ranks");
  }
};

}  // namespace podm
