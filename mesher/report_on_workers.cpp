#include "report_on_workers.h"

namespace podm {

namespace {

void add(const std::vector<std::uint64_t>& terms, std::vector<std::uint64_t>& sums) {
  sums.resize(std::max(sums.size(), terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) sums[i] += terms[i];
}

std::vector<std::uint64_t> by_hops(const std::vector<std::uint64_t>& by_node, int own_node,
                                   const Topology* machine) {
  if (by_node.empty() || machine == nullptr) return {};
  std::vector<std::uint64_t> by_hops(static_cast<std::size_t>(machine->max_hops()) + 1);
  for (std::size_t node = 0; node < by_node.size(); ++node)
    by_hops[static_cast<std::size_t>(machine->hops(own_node, static_cast<int>(node)))] += by_node[node];
  return by_hops;
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
  c.accesses_by_hops = by_hops(o.accesses_by_node, place.node, machine);
  return c;
}

void add(const Counters& c, Counters& sum) {
  for (std::size_t rule = 0; rule < sum.insertions_by_rule.size(); ++rule)
    sum.insertions_by_rule[rule] += c.insertions_by_rule[rule];
  sum.removals += c.removals;
  sum.rejected += c.rejected;
  sum.stale_cells += c.stale_cells;
  sum.classified_cells += c.classified_cells;
  sum.conflict_tests += c.conflict_tests;
  sum.exact_decisions += c.exact_decisions;
  sum.cells_created += c.cells_created;
  sum.lock_conflicts += c.lock_conflicts;
  sum.out_of_leaf += c.out_of_leaf;
  sum.region_cells += c.region_cells;
  sum.contention_s += c.contention_s;
  sum.begging_s += c.begging_s;
  sum.rollback_s += c.rollback_s;
  add(c.accesses_by_hops, sum.accesses_by_hops);
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
