#include "algorithms/page_sampler.h"

#include <algorithm>

namespace podm {

namespace {

constexpr std::size_t kMostSamples = 1000;  // per array

// All addresses of one point in time, for one query.
class Question {
 public:
  /// Adds samples of `size` elements, spread evenly.
  template <class AddressOf, class NodeOf>
  void add(const std::string& name, std::size_t size, const AddressOf& address_of, const NodeOf& node_of) {
    const std::size_t step = std::max<std::size_t>(1, size / kMostSamples);
    for (std::size_t i = 0; i < size; i += step) {
      addresses_.push_back(address_of(i));
      nodes_.push_back(node_of(i));
    }
    arrays_.push_back({name, addresses_.size()});
  }
  void add(const SampledAccesses& accesses) {
    for (const void* address : accesses.addresses) {
      addresses_.push_back(address);
      nodes_.push_back(accesses.node);
    }
  }

  std::span<const void* const> addresses() const { return addresses_; }
  PageSamples::AtPhase judge(const std::string& phase, const std::vector<int>& os_indices,
                             const Topology& machine) const;

 private:
  struct Array {
    std::string name;
    std::size_t end;  // of its part of addresses_, which begins at the end of the previous one
  };
  std::vector<Array> arrays_;
  std::vector<const void*> addresses_;
  std::vector<int> nodes_;  // per address: the owner's or, after the arrays, the accessor's
};

PageSamples::AtPhase Question::judge(const std::string& phase, const std::vector<int>& os_indices,
                                     const Topology& machine) const {
  PageSamples::AtPhase at{
      phase, {}, std::vector<std::uint64_t>(static_cast<std::size_t>(machine.max_hops()) + 1)};
  std::size_t i = 0;
  for (const Array& array : arrays_) {
    PageSamples::OfArray pages{array.name};
    for (; i < array.end; ++i)
      ++(os_indices[i] == PageNodes::kNowhere                ? pages.untouched
         : os_indices[i] == machine.node_os_index(nodes_[i]) ? pages.as_claimed
                                                             : pages.elsewhere);
    at.arrays.push_back(pages);
  }
  for (; i < addresses_.size(); ++i)
    for (int node = 0; node < machine.num_nodes(); ++node)
      if (machine.node_os_index(node) == os_indices[i])
        ++at.accesses_by_hops[static_cast<std::size_t>(machine.hops(nodes_[i], node))];
  return at;
}

void add(const std::string& name, const MemoryOwners& owners, Question& question) {
  question.add(
      name, owners.size(), [&](std::size_t i) { return owners.address_of(i); },
      [&](std::size_t i) { return owners.node_of(i); });
}

}  // namespace

void PageSampler::sample(const std::string& phase, const Mesh& mesh,
                         std::span<const SampledAccesses> accesses, PageSamples& samples) const {
  if (!samples.unavailable.empty()) return;
  Question question;
  const auto id = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  const auto node_of_cell = [&](std::size_t c) { return mesh.node_of_cell(id(c)); };
  question.add(
      "cells", mesh.cell_bound(), [&](std::size_t c) { return &mesh.cell(id(c)); }, node_of_cell);
  question.add(
      "vertices", mesh.vertex_bound(), [&](std::size_t v) { return &mesh.vertex(id(v)); },
      [&](std::size_t v) { return mesh.node_of_vertex(id(v)); });
  if (owners_.unavailable().empty()) {
    add("image", owners_.image, question);
    add("transform", owners_.transform, question);
  }
  for (const SampledAccesses& of_worker : accesses) question.add(of_worker);
  PageNodes answer = query_(question.addresses());
  samples.unavailable = std::move(answer.unavailable);
  if (samples.unavailable.empty())
    samples.phases.push_back(question.judge(phase, answer.os_indices, machine_));
}

}  // namespace podm
