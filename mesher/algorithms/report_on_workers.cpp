#include "algorithms/report_on_workers.h"

namespace podm {

namespace {

// What add() sums besides insertions and accesses.
constexpr std::uint64_t Counters::*kCounts[] = {&Counters::removals,       &Counters::rejected,
                                                &Counters::stale_cells,    &Counters::classified_cells,
                                                &Counters::conflict_tests, &Counters::exact_decisions,
                                                &Counters::cells_created,  &Counters::lock_conflicts,
                                                &Counters::out_of_leaf,    &Counters::region_cells};
constexpr double Counters::*kSeconds[] = {&Counters::contention_s, &Counters::begging_s,
                                          &Counters::rollback_s};

constexpr std::pair<std::vector<std::uint64_t> HopsByKind::*, AccessKind> kHops[] = {
    {&HopsByKind::mesh_reads, AccessKind::kMeshRead},
    {&HopsByKind::mesh_writes, AccessKind::kMeshWrite},
    {&HopsByKind::image_reads, AccessKind::kImageRead},
    {&HopsByKind::transform_reads, AccessKind::kTransformRead}};
static_assert(std::size(kHops) == kNumAccessKinds);

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

HopsByKind hops_of(const std::optional<AccessTally>& accesses, int own_node, const Topology* machine) {
  if (!accesses || machine == nullptr) return {};
  HopsByKind hops;
  for (const auto& [member, kind] : kHops)
    hops.*member = by_hops(accesses->by_node(kind), own_node, *machine);
  return hops;
}

}  // namespace

template <class Locks>
Counters counters_of(const Worker<Locks>& worker, const Overhead& overhead, const Place& place,
                     const Topology* machine) {
  const WorkerCounters& w = worker.counters();
  const OperationCounters& o = worker.operation_counters();
  Counters c;
  c.insertions_by_rule = w.insertions_by_rule;
  c.removals = w.removals;
  c.rejected = w.rejected;
  c.stale_cells = w.stale_cells;
  c.classified_cells = w.classified_cells;
  c.conflict_tests = o.conflict_tests;
  c.exact_decisions = o.exact_decisions;
  c.cells_created = o.cells_created;
  c.lock_conflicts = w.lock_conflicts;
  c.out_of_leaf = w.out_of_leaf;
  c.region_cells = o.region_cells;
  c.contention_s = overhead.contention_s;
  c.begging_s = overhead.begging_s;
  c.rollback_s = overhead.rollback_s;
  c.hops = hops_of(worker.accesses(), place.node, machine);
  return c;
}

void add(const Counters& c, Counters& sum) {
  for (std::size_t rule = 0; rule < sum.insertions_by_rule.size(); ++rule)
    sum.insertions_by_rule[rule] += c.insertions_by_rule[rule];
  for (const auto count : kCounts) sum.*count += c.*count;
  for (const auto seconds : kSeconds) sum.*seconds += c.*seconds;
  for (const auto& [member, kind] : kHops) add(c.hops.*member, sum.hops.*member);
}

Counters sum_of(const std::vector<WorkerReport>& workers) {
  Counters sum;
  for (const WorkerReport& worker : workers) add(worker.counters, sum);
  return sum;
}

template Counters counters_of(const Worker<NoLocks>&, const Overhead&, const Place&, const Topology*);
template Counters counters_of(const Worker<VertexLocks>&, const Overhead&, const Place&, const Topology*);
template Counters counters_of(const Worker<LeafLocks<NoLocks>>&, const Overhead&, const Place&,
                              const Topology*);
template Counters counters_of(const Worker<LeafLocks<VertexLocks>>&, const Overhead&, const Place&,
                              const Topology*);

}  // namespace podm
