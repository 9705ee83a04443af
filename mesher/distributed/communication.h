// What ranks say to each other: few words, so that there may be two who carry them (in_process_ranks.h,
// mpi_communication.h). Every function is collective: all ranks call the same ones in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace podm {

using Bytes = std::vector<std::byte>;

class Communication {
 public:
  virtual ~Communication() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Sends a message to each rank, and returns what each rank sent to this one, both by rank. Empty ones cost
  /// nothing but their size.
  virtual std::vector<Bytes> all_to_all(std::vector<Bytes> messages) = 0;
  /// What every rank tells, by rank.
  virtual std::vector<Bytes> all_gather(Bytes message) = 0;
  /// Each value becomes its sum, or its maximum, over all ranks.
  virtual void sum(std::span<std::uint64_t> values) = 0;
  virtual void maximum(std::span<std::uint64_t> values) = 0;
  /// Returns when all ranks have called it.
  virtual void barrier() = 0;
};

}  // namespace podm
