#include "runtime/memory_owners.h"

#include <fmt/format.h>

#include <bit>
#include <map>
#include <random>

namespace podm {

MemoryOwners::MemoryOwners(std::span<const std::byte> array, std::size_t element_bytes, unsigned piece_bits)
    : array_(array),
      element_bytes_(element_bytes),
      piece_bits_(piece_bits - static_cast<unsigned>(std::countr_zero(element_bytes))),
      node_of_piece_((array.size() >> piece_bits) + 1) {}

void MemoryOwners::ask(const Topology& machine, const PageQuery& query) {
  std::map<int, NodeIndex> node_of_os_index;
  for (int node = 0; node < machine.num_nodes(); ++node)
    node_of_os_index[machine.node_os_index(node)] = static_cast<NodeIndex>(node);
  std::vector<const void*> pages;
  for (std::size_t first = 0; first < size(); first += std::size_t{1} << piece_bits_)
    pages.push_back(address_of(first));
  const PageNodes answer = query(pages);
  unavailable_ = answer.unavailable;
  for (std::size_t piece = 0; unavailable_.empty() && piece < answer.os_indices.size(); ++piece) {
    const int os_index = answer.os_indices[piece];
    if (const auto found = node_of_os_index.find(os_index); found != node_of_os_index.end()) {
      node_of_piece_[piece] = found->second;
    } else {
      unavailable_ =
          os_index == PageNodes::kNowhere
              ? "a page of it has no memory yet"
              : fmt::format("a page of it is on node {}, which this process may not use", os_index);
    }
  }
}

void MemoryOwners::deal(std::span<const NodeIndex> nodes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (NodeIndex& node : node_of_piece_) node = nodes[random() % nodes.size()];
}

}  // namespace podm
