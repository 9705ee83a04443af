// The NUMA nodes that own the pieces of a shared array: for arrays that no worker's pool made.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "runtime/access_tally.h"
#include "runtime/numa_memory.h"
#include "runtime/topology.h"

namespace podm {

class MemoryOwners {
 public:
  /// Queries this machine for the node of the first page of each 64 KiB. If the query fails, unavailable()
  /// gives the reason.
  template <class T>
  static MemoryOwners ask(std::span<const T> array, const Topology& machine, const PageQuery& query) {
    MemoryOwners owners(std::as_bytes(array), sizeof(T), kBytesAskedOnce);
    owners.ask(machine, query);
    return owners;
  }
  /// Draws owners for a described machine, where no thread touches the memory. Parallel loops give pieces of
  /// 2^`piece_bits` bytes to any free worker. Therefore each piece belongs to a worker drawn at random; the
  /// same seed gives the same owners. `nodes` are the workers' nodes.
  template <class T>
  static MemoryOwners deal(std::span<const T> array, unsigned piece_bits, std::span<const NodeIndex> nodes,
                           std::uint64_t seed) {
    MemoryOwners owners(std::as_bytes(array), sizeof(T), piece_bits);
    owners.deal(nodes, seed);
    return owners;
  }

  /// Returns the reason why no piece's owner is known; otherwise empty.
  const std::string& unavailable() const { return unavailable_; }
  /// Returns the node of an element of the array.
  NodeIndex node_of(std::size_t element) const { return node_of_piece_[element >> piece_bits_]; }
  const void* address_of(std::size_t element) const { return array_.data() + byte_of(element); }
  std::size_t byte_of(std::size_t element) const { return element * element_bytes_; }
  std::size_t num_bytes() const { return array_.size(); }
  std::size_t size() const { return array_.size() / element_bytes_; }

 private:
  static constexpr unsigned kBytesAskedOnce = 16;  // log2

  MemoryOwners(std::span<const std::byte> array, std::size_t element_bytes, unsigned piece_bits);
  void ask(const Topology& machine, const PageQuery& query);
  void deal(std::span<const NodeIndex> nodes, std::uint64_t seed);

  std::span<const std::byte> array_;
  std::size_t element_bytes_;  // a power of two
  unsigned piece_bits_;        // 2^piece_bits_ elements make a piece
  std::vector<NodeIndex> node_of_piece_;
  std::string unavailable_;
};

}  // namespace podm
