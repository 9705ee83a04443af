#include "algorithms/report_on_workers.h"

namespace podm {

namespace {

constexpr std::pair<std::vector<std::uint64_t> HopsByKind::*, AccessKind> kHops[] = {
    {&HopsByKind::mesh_reads, AccessKind::kMeshRead},
    {&HopsByKind::mesh_writes, AccessKind::kMeshWrite},
    {&HopsByKind::image_reads, AccessKind::kImageRead},
    {&HopsByKind::transform_reads, AccessKind::kTransformRead}};
static_assert(std::size(kHops) == kNumAccessKinds - 1, "first reads are among the others");

void add(const std::vector<std::uint64_t>& terms, std::vector<std::uint64_t>& sums) {
  sums.resize(std::max(sums.size(), terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) sums[i] += terms[i];
}

std::vector<std::uint64_t> by_hops(const std::vector<std::uint64_t>& by_node, int own_node,
                                   const Topology& machine) {
  std::vector<std::uint64_t> by_hops(static_cast<std::size_t>(machine.max_hops()) + 1);
  for (std::size_t node = 0; node < by_node.size(); ++node)
    by_hops[static_cast<std::size_t>(machine.hops(own_node, static_cast<int>(node)))] += by_node[node];
  return by_hops;
}

}  // namespace

HopsByKind hops_of(const std::optional<AccessTally>& accesses, int own_node, const Topology* machine) {
  if (!accesses || machine == nullptr) return {};
  HopsByKind hops;
  for (const auto& [member, kind] : kHops)
    hops.*member = by_hops(accesses->by_node(kind), own_node, *machine);
  return hops;
}

void add(const Counters& terms, Counters& sums) {
  for (std::size_t rule = 0; rule < sums.insertions_by_rule.size(); ++rule)
    sums.insertions_by_rule[rule] += terms.insertions_by_rule[rule];
  for (const Count& count : kCounts) sums.*count.member += terms.*count.member;
  for (const Cause& cause : kCauses) sums.overhead.*cause.member += terms.overhead.*cause.member;
  for (const auto& [member, kind] : kHops) add(terms.hops.*member, sums.hops.*member);
}

Counters sum_of(const std::vector<WorkerReport>& workers) {
  Counters sum;
  for (const WorkerReport& worker : workers) add(worker.counters, sum);
  return sum;
}

}  // namespace podm
