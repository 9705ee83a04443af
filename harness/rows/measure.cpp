#include "rows/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "options/option_matrix.h"

namespace podm::bench {
namespace {

Value absent(const std::string& why) { return {{}, why}; }

// Returns the number at a place, or the reason why rows have none.
template <class T>
Value number_or_reason(const std::optional<T>& number, const char* place) {
  if (!number) return absent(fmt::format("rows have no {}", place));
  return {static_cast<double>(*number), ""};
}

Value sum_of(const ByName<std::uint64_t>& parts) {
  double sum = 0;
  for (const auto& [name, number] : parts) sum += static_cast<double>(number);
  return {sum, ""};
}

Value quotient(const Value& dividend, const Value& divisor) {
  if (!dividend.number) return dividend;
  if (!divisor.number) return divisor;
  if (*divisor.number <= 0) return absent("a divisor is 0");
  return {*dividend.number / *divisor.number, ""};
}

// Returns a member of a part of the mesher's record; both may be absent.
template <class Part, class T>
Value of_mesh(const Row& row, std::optional<Part> MeshRecord::*part, std::optional<T> Part::*member,
              const char* place) {
  const bool is_there = row.mesh && *row.mesh.*part;
  return number_or_reason(is_there ? *(*row.mesh.*part).*member : std::optional<T>(), place);
}

Value cells(const Row& row) {
  return row.mesh ? Value{static_cast<double>(row.mesh->cells), ""} : absent("rows have no cells");
}
Value threads(const Row& row) {
  const Json threads = row.asked.value("threads", Json());
  return threads.is_number() ? Value{threads.get<double>(), ""} : absent("rows have no asked/threads");
}

Value seconds(const Row& row) {
  return row.mesh ? Value{meshing_seconds(row.mesh->phases_s), ""} : absent("rows have no phases_s");
}

// Refining consists of these phases. A phase that an algorithm does not have costs nothing.
Value refining_seconds_of(const ByName<double>& phases_s) {
  if (phases_s.find("refine") == nullptr) return absent("rows have no phases_s/refine");
  double sum = 0;
  for (const char* phase : {"refine", "initial", "octree", "closing"})
    if (const double* phase_s = phases_s.find(phase)) sum += *phase_s;
  return {sum, ""};
}
Value refining_seconds(const Row& row) {
  return row.mesh ? refining_seconds_of(row.mesh->phases_s) : absent("rows have no phases_s");
}

// From the input in memory to the mesh in memory: eq. (1) without reading. For a mesher that begins with a
// finished surface the making of that surface counts, too.
Value whole_seconds(const Row& row) {
  const Value all = seconds(row);
  if (!all.number) return all;
  const double* const read_s = row.mesh->phases_s.find("read");
  return {*all.number - (read_s == nullptr ? 0 : *read_s), ""};
}
Value whole_cells_per_second(const Row& row) { return quotient(cells(row), whole_seconds(row)); }

// From the finished surface to the mesh. Cells that came with the surface are not counted.
Value volume_seconds(const Row& row) {
  const double* const surface_s = row.mesh ? row.mesh->phases_s.find("surface") : nullptr;
  if (surface_s == nullptr) return absent("rows have no phases_s/surface");
  return {*whole_seconds(row).number - *surface_s, ""};
}
Value volume_cells_per_second(const Row& row) {
  if (!row.mesh) return absent("rows have no cells");
  const auto num_before = static_cast<double>(row.mesh->surface_cells.value_or(0));
  return quotient({static_cast<double>(row.mesh->cells) - num_before, ""}, volume_seconds(row));
}

Value boundary_facets(const Row& row) {
  return number_or_reason(row.mesh ? row.mesh->boundary_facets : std::nullopt, "boundary_facets");
}

Value cells_per_second(const Row& row) { return quotient(cells(row), seconds(row)); }
Value cells_per_second_and_core(const Row& row) { return quotient(cells_per_second(row), threads(row)); }
Value refining_cells_per_second(const Row& row) { return quotient(cells(row), refining_seconds(row)); }
Value refining_cells_per_second_and_core(const Row& row) {
  return quotient(refining_cells_per_second(row), threads(row));
}

// Returns the sum over all processes that ran at the same time, or the rate of a single process.
Value side_by_side_refining_cells_per_second(const Row& row) {
  if (!row.side_by_side) return refining_cells_per_second(row);
  double sum = 0;
  for (const CopyRecord& copy : *row.side_by_side) {
    const Value rate = quotient({static_cast<double>(copy.cells), ""}, refining_seconds_of(copy.phases_s));
    if (!rate.number) return rate;
    sum += *rate.number;
  }
  return {sum, ""};
}

constexpr std::array kRefiningOfRank{"initial", "refine", "later", "exchange"};
constexpr const char* kMeasureOfRank = "measure";  // makes no part of the mesh

bool is_meshing(const std::string& phase) { return phase != kMeasureOfRank; }
bool is_refining(const std::string& phase) {
  return std::find(kRefiningOfRank.begin(), kRefiningOfRank.end(), phase) != kRefiningOfRank.end();
}

const RanksRecord* ranks_of(const Row& row) {
  return row.mesh && row.mesh->ranks ? &*row.mesh->ranks : nullptr;
}
Value no_ranks() { return absent("rows have no ranks"); }

// Returns the sum over all ranks, for the phases that `is_counted` selects.
double processor_seconds_of(const RanksRecord& ranks, bool (*is_counted)(const std::string& phase)) {
  double sum = 0;
  for (const RankRecord& rank : ranks.by_rank)
    for (const auto& [phase, spent] : rank.spent)
      if (is_counted(phase)) sum += spent.computing_s;
  return sum;
}
Value processor_seconds(const Row& row) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{processor_seconds_of(*ranks, is_meshing), ""};
}
Value refining_processor_seconds(const Row& row) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{processor_seconds_of(*ranks, is_refining), ""};
}

// Returns the seconds of the rank that finishes last.
double seconds_of_last(const RanksRecord& ranks, bool (*is_counted)(const std::string& phase)) {
  double most = 0;
  for (const RankRecord& rank : ranks.by_rank) {
    double sum = 0;
    for (const auto& [phase, spent] : rank.spent)
      if (is_counted(phase)) sum += spent.computing_s + spent.waiting_s + spent.network_s;
    most = std::max(most, sum);
  }
  return most;
}

Value number_of_ranks(const Row& row) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{static_cast<double>(ranks->number), ""};
}
Value rounds(const Row& row) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{static_cast<double>(ranks->rounds.size()), ""};
}
Value imbalance(const Row& row) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{ranks->imbalance, ""};
}
Value deferred_share(const Row& row) {
  const auto* const ranks = ranks_of(row);
  if (ranks == nullptr) return no_ranks();
  if (ranks->rounds.empty()) return absent("one rank has no rounds");
  return quotient({static_cast<double>(ranks->rounds.front().deferred), ""}, cells(row));
}
Value cells_over_one_machine(const Row& row) {
  if (!row.resolved) return absent("rows have no resolved");
  return quotient(cells(row), {static_cast<double>(row.resolved->cells), ""});
}
Value bytes_per_cell_beyond_image(const Row& row) {
  return number_or_reason(row.process.bytes_per_cell_beyond_image, "process/bytes_per_cell_beyond_image");
}

Value virtual_refining_seconds(const Row& row) {
  if (const auto* const ranks = ranks_of(row)) return {seconds_of_last(*ranks, is_refining), ""};
  return of_mesh(row, &MeshRecord::virtual_time, &VirtualRecord::refine_s, "virtual/refine_s");
}
Value virtual_seconds(const Row& row) {
  if (const auto* const ranks = ranks_of(row)) return {seconds_of_last(*ranks, is_meshing), ""};
  const bool is_there = row.mesh && row.mesh->virtual_time && row.mesh->virtual_time->phases_s;
  return is_there ? Value{meshing_seconds(*row.mesh->virtual_time->phases_s), ""}
                  : absent("rows have no virtual/phases_s");
}
Value virtual_cells_per_second(const Row& row) { return quotient(cells(row), virtual_seconds(row)); }
Value virtual_cells_per_second_and_rank(const Row& row) {
  return quotient(virtual_cells_per_second(row), number_of_ranks(row));
}
Value virtual_refining_cells_per_second_and_rank(const Row& row) {
  return quotient(quotient(cells(row), virtual_refining_seconds(row)), number_of_ranks(row));
}

// Returns the share of phases in the virtual seconds of eq. (1).
template <std::size_t N>
Value share_of_virtual_seconds(const Row& row, const std::array<const char*, N>& phases) {
  const Value whole = virtual_seconds(row);
  if (!whole.number || !row.mesh->virtual_time || !row.mesh->virtual_time->phases_s)
    return absent("rows have no virtual/phases_s");
  double sum = 0;
  for (const char* phase : phases)
    if (const double* const phase_s = row.mesh->virtual_time->phases_s->find(phase)) sum += *phase_s;
  return quotient({sum, ""}, whole);
}
Value virtual_octree_share(const Row& row) {
  return share_of_virtual_seconds(row, std::array{"allocate", "octree"});
}

// Returns the seconds of all virtual workers, summed over the causes that `is_counted` selects.
Value virtual_worker_seconds(const Row& row, bool (*is_counted)(const std::string& cause)) {
  const bool is_there = row.mesh && row.mesh->virtual_time && row.mesh->virtual_time->worker_s;
  if (!is_there) return absent("rows have no virtual/worker_s");
  double sum = 0;
  for (const auto& [cause, spent_s] : *row.mesh->virtual_time->worker_s)
    if (is_counted(cause)) sum += spent_s;
  return {sum, ""};
}
bool is_any_cause(const std::string&) { return true; }
bool is_waiting_for_work(const std::string& cause) { return cause == "begging"; }
// True for handling of lists, gifts and leaves handed over, and for waiting for the queue of leaves.
bool is_distributing(const std::string& cause) { return cause == "between_attempts" || cause == "locks"; }

Value waiting_share(const Row& row) {
  return quotient(virtual_worker_seconds(row, is_waiting_for_work),
                  virtual_worker_seconds(row, is_any_cause));
}
Value distributing_share(const Row& row) {
  return quotient(virtual_worker_seconds(row, is_distributing), virtual_worker_seconds(row, is_any_cause));
}
Value worker_seconds_per_cell_but_distributing(const Row& row) {
  return quotient(
      virtual_worker_seconds(row, [](const std::string& cause) { return !is_distributing(cause); }),
      cells(row));
}

Value contention_seconds(const Row& row) {
  return of_mesh(row, &MeshRecord::overhead_s, &OverheadRecord::contention, "overhead_s/contention");
}
Value rollback_seconds(const Row& row) {
  return of_mesh(row, &MeshRecord::overhead_s, &OverheadRecord::rollback, "overhead_s/rollback");
}
Value begging_seconds(const Row& row) {
  return of_mesh(row, &MeshRecord::overhead_s, &OverheadRecord::begging, "overhead_s/begging");
}
Value lost_seconds(const Row& row) {
  const Value contention = contention_seconds(row), rollback = rollback_seconds(row);
  if (!contention.number || !rollback.number) return contention.number ? rollback : contention;
  return {*contention.number + *rollback.number, ""};
}

Value deferred_operations(const Row& row) {
  return of_mesh(row, &MeshRecord::outcomes, &OutcomesRecord::out_of_leaf, "outcomes/out_of_leaf");
}

// Accesses to the own node and all accesses, or the reason why they are not available.
struct AccessCounts {
  double near = 0, all = 0;
  std::string absence;

  void add(const Hops& hops) {
    const auto* const numbers = std::get_if<std::vector<std::uint64_t>>(&hops);
    if (numbers == nullptr) {
      absence = std::get<Unavailable>(hops).text();
      return;
    }
    for (const std::uint64_t number : *numbers) all += static_cast<double>(number);
    near += numbers->empty() ? 0 : static_cast<double>(numbers->front());
  }
  Value near_share() const { return absence.empty() ? quotient({near, ""}, {all, ""}) : absent(absence); }
};

Value zero_hop_share(const Row& row) {
  if (!row.mesh || !row.mesh->hops) return absent("rows have no hops");
  AccessCounts counts;
  counts.add(*row.mesh->hops);
  return counts.near_share();
}

// Counts also the accesses that Table 2 leaves out.
Value zero_hop_share_of_all_kinds(const Row& row) {
  if (!row.mesh || !row.mesh->hops_by_kind) return absent("rows have no hops_by_kind");
  const auto* const kinds = std::get_if<ByName<Hops>>(&*row.mesh->hops_by_kind);
  if (kinds == nullptr) return absent(std::get<Unavailable>(*row.mesh->hops_by_kind).text());
  AccessCounts counts;
  for (const auto& [kind, hops] : *kinds) {
    counts.add(hops);
    if (!counts.absence.empty()) return absent(fmt::format("{}: {}", kind, counts.absence));
  }
  return counts.near_share();
}

// Returns a count of the trial's process, or the reason why there is none.
Value count(const Row& row, const std::string& name) {
  const auto* const counted = row.process.counters.find(name);
  if (counted == nullptr) return absent("rows have no process/counters/" + name);
  const auto* const counter = std::get_if<Counter>(counted);
  if (counter == nullptr) return absent(name + ": " + std::get<Unavailable>(*counted).text());
  return {as_double(counter->value), ""};
}

// Returns the misses counted by the requested source. If likwid cannot count, the kernel counts instead, and
// its counts are not used. Loads and stores are added if the source reports both.
Value last_level_misses(const Row& row) {
  const std::string source = row.asked.value(kCounters, kPerfEvent);
  if (row.process.counters.find(source) != nullptr) return count(row, source);
  if (source.starts_with(kLikwid)) {
    for (const char* event : {"MEM_LOAD_RETIRED_L3_MISS", "L3_CACHE_REQ_MISS"})
      if (const Value misses = count(row, event); misses.number) return misses;
    return absent(source + " counts no misses of the last level");
  }
  const Value loads = count(row, "llc_load_misses");
  if (!loads.number) return loads;
  return {*loads.number + count(row, "llc_store_misses").number.value_or(0), ""};
}

Value insertions(const Row& row) {
  if (!row.mesh || !row.mesh->counters || !row.mesh->counters->insertions)
    return absent("rows have no counters/insertions");
  return sum_of(*row.mesh->counters->insertions);
}

// Cycles of a load from the caches in their order, from the own memory, and from the memory of other nodes.
struct Levels {
  std::vector<double> caches, others;
  std::optional<double> own;
  std::string absence;
};

Levels levels_of(const Row& row) {
  if (!row.measured) return {{}, {}, {}, "rows have no memory_levels"};
  Levels levels;
  for (const MemoryLevel& level : row.measured->memory_levels) {
    const auto* const cycles = std::get_if<double>(&level.cycles);
    if (cycles == nullptr) {
      levels.absence = fmt::format("{}: {}", level.module, std::get<Unavailable>(level.cycles).text());
      break;
    }
    if (level.module.ends_with("cache"))
      levels.caches.push_back(*cycles);
    else if (level.module.starts_with("memory of the own"))
      levels.own = *cycles;
    else
      levels.others.push_back(*cycles);
  }
  if (levels.absence.empty() && levels.caches.empty()) levels.absence = "hwloc lists no caches";
  if (levels.absence.empty() && !levels.own) levels.absence = "rows do not record the memory of the own node";
  return levels;
}

Value first_cache_cycles(const Row& row) {
  const Levels levels = levels_of(row);
  return levels.absence.empty() ? Value{levels.caches.front(), ""} : absent(levels.absence);
}

Value least_step_between_levels(const Row& row) {
  Levels levels = levels_of(row);
  if (!levels.absence.empty()) return absent(levels.absence);
  levels.caches.push_back(*levels.own);
  double least = levels.caches[1] / levels.caches[0];
  for (std::size_t i = 2; i < levels.caches.size(); ++i)
    least = std::min(least, levels.caches[i] / levels.caches[i - 1]);
  return {least, ""};
}

Value memory_over_last_cache(const Row& row) {
  const Levels levels = levels_of(row);
  return levels.absence.empty() ? Value{*levels.own / levels.caches.back(), ""} : absent(levels.absence);
}

Value other_node_over_own(const Row& row) {
  const Levels levels = levels_of(row);
  if (!levels.absence.empty()) return absent(levels.absence);
  if (levels.others.empty()) return absent("one NUMA node");
  return {*std::min_element(levels.others.begin(), levels.others.end()) / *levels.own, ""};
}

Value guarantee_misses(const Row& row) {
  return row.mesh ? sum_of(row.mesh->guarantees) : absent("rows have no guarantees");
}

const ByName<Proof>* verdicts_of(const Row& row) {
  return row.mesh && row.mesh->verdicts ? &*row.mesh->verdicts : nullptr;
}

// not_run never counts as pass.
Value unproved_claims(const Row& row) {
  const auto* const verdicts = verdicts_of(row);
  if (verdicts == nullptr || verdicts->empty()) return absent("podm-verify did not run");
  return {
      static_cast<double>(std::count_if(verdicts->begin(), verdicts->end(),
                                        [](const auto& verdict) { return verdict.second != Proof::kPass; })),
      ""};
}

Value yes(bool is_so) { return {is_so ? 1.0 : 0.0, ""}; }

Value proved(const Row& row, const std::string& claim) {
  const auto* const verdicts = verdicts_of(row);
  const Proof* const verdict = verdicts == nullptr ? nullptr : verdicts->find(claim);
  return verdict == nullptr ? absent(fmt::format("podm-verify was not asked for {}", claim))
                            : yes(*verdict == Proof::kPass);
}
Value conformity_proved(const Row& row) { return proved(row, "conformity"); }
Value fidelity_proved(const Row& row) { return proved(row, "fidelity"); }
Value dihedral_proved(const Row& row) { return proved(row, "dihedral"); }
Value radius_edge_proved(const Row& row) { return proved(row, "radius_edge"); }
Value boundary_angles_proved(const Row& row) { return proved(row, "boundary_angles"); }

Value topology_as_image(const Row& row) {
  if (!row.mesh || !row.mesh->topology) return absent("rows have no topology");
  const TopologyRecord& topology = *row.mesh->topology;
  return yes(topology.components_as_image == topology.labels && topology.euler_as_image == topology.labels);
}

template <SystemRecord SolveRecord::*system, IterationsRecord SystemRecord::*preconditioner>
Value iterations(const Row& row) {
  if (!row.solve) return absent("rows have no solve");
  return {static_cast<double>(((*row.solve).*system.*preconditioner).iterations), ""};
}

// Returns the seconds of the stages that remove slivers.
Value dihedral_seconds(const Row& row) {
  double sum = 0;
  bool is_any = false;
  for (const char* phase : {"perturb", "optimize"}) {
    const double* phase_s = row.mesh ? row.mesh->phases_s.find(phase) : nullptr;
    if (phase_s == nullptr) continue;
    sum += *phase_s;
    is_any = true;
  }
  return is_any ? Value{sum, ""} : absent("rows have neither phases_s/perturb nor phases_s/optimize");
}
Value dihedral_cells_per_second(const Row& row) { return quotient(cells(row), dihedral_seconds(row)); }

const PerturbedRecord* perturbed_of(const Row& row) {
  return row.mesh && row.mesh->perturbed ? &*row.mesh->perturbed : nullptr;
}
Value poor_share_left(const Row& row) {
  const auto* const perturbed = perturbed_of(row);
  if (perturbed == nullptr) return absent("rows have no perturbed");
  return quotient({static_cast<double>(perturbed->after.with_free_vertex), ""},
                  {static_cast<double>(perturbed->before.with_free_vertex), ""});
}

Value beyond_bounds_per_million(const Row& row) {
  if (!row.mesh || !row.mesh->optimization) return absent("rows have no optimization");
  return quotient({1e6 * static_cast<double>(row.mesh->optimization->beyond_bounds), ""}, cells(row));
}

Value replay_equal(const Row& row) {
  return row.replay ? yes(row.replay->end == Replay::End::kEqual) : absent("no replay was asked for");
}

Value has_ended(const Row& row) { return yes(is_finished(row)); }
Value has_passed(const Row& row) { return yes(row.status == Status::kOk); }

constexpr auto kLess = Better::kLess, kMore = Better::kMore;
using enum Meaning;

constexpr Measure kMeasures[] = {
    {"seconds", "s", kLess, kClock, seconds},
    {"refining_seconds", "s", kLess, kClock, refining_seconds},
    {"whole_seconds", "s", kLess, kClock, whole_seconds},
    {"whole_cells_per_second", "1/s", kMore, kClock, whole_cells_per_second},
    {"volume_seconds", "s", kLess, kClock, volume_seconds},
    {"volume_cells_per_second", "1/s", kMore, kClock, volume_cells_per_second},
    {"cells_per_second", "1/s", kMore, kClock, cells_per_second},
    {"cells_per_second_and_core", "1/s", kMore, kClock, cells_per_second_and_core},
    {"refining_cells_per_second", "1/s", kMore, kClock, refining_cells_per_second},
    {"refining_cells_per_second_and_core", "1/s", kMore, kClock, refining_cells_per_second_and_core},
    {"side_by_side_refining_cells_per_second", "1/s", kMore, kClock, side_by_side_refining_cells_per_second},
    {"virtual_refining_seconds", "s", kLess, kVirtualClock, virtual_refining_seconds},
    {"virtual_cells_per_second", "1/s", kMore, kVirtualClock, virtual_cells_per_second},
    {"virtual_cells_per_second_and_rank", "1/s", kMore, kVirtualClock, virtual_cells_per_second_and_rank},
    {"virtual_refining_cells_per_second_and_rank", "1/s", kMore, kVirtualClock,
     virtual_refining_cells_per_second_and_rank},
    {"virtual_octree_share", "", kLess, kVirtualClock, virtual_octree_share},
    {"waiting_share", "", kLess, kVirtualClock, waiting_share},
    {"distributing_share", "", kLess, kVirtualClock, distributing_share},
    {"worker_seconds_per_cell_but_distributing", "s", kLess, kVirtualClock,
     worker_seconds_per_cell_but_distributing},
    {"processor_seconds", "s", kLess, kClock, processor_seconds},
    {"refining_processor_seconds", "s", kLess, kClock, refining_processor_seconds},
    {"rounds", "", kLess, kCount, rounds},
    {"deferred_share", "", kLess, kCount, deferred_share},
    {"imbalance", "", kLess, kCount, imbalance},
    {"cells_over_one_machine", "", kLess, kCount, cells_over_one_machine},
    {"bytes_per_cell_beyond_image", "", kLess, kCost, bytes_per_cell_beyond_image},
    {"contention_seconds", "s", kLess, kCost, contention_seconds},
    {"rollback_seconds", "s", kLess, kCost, rollback_seconds},
    {"begging_seconds", "s", kLess, kCost, begging_seconds},
    {"lost_seconds", "s", kLess, kCost, lost_seconds},
    {"deferred_operations", "", kLess, kCount, deferred_operations},
    {"zero_hop_share", "", kMore, kCount, zero_hop_share},
    {"zero_hop_share_of_all_kinds", "", kMore, kCount, zero_hop_share_of_all_kinds},
    {"last_level_misses_per_further_insertion", "", kLess, kCost, last_level_misses, insertions},
    {"first_cache_cycles", "cycles", kLess, kClock, first_cache_cycles},
    {"least_step_between_levels", "", kMore, kClock, least_step_between_levels},
    {"memory_over_last_cache", "", kMore, kClock, memory_over_last_cache},
    {"other_node_over_own", "", kMore, kClock, other_node_over_own},
    {"cells", "", kMore, kCount, cells},
    {"boundary_facets", "", kMore, kCount, boundary_facets},
    {"guarantee_misses", "", kLess, kFaults, guarantee_misses},
    {"unproved_claims", "", kLess, kFaults, unproved_claims},
    {"poisson_jacobi_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::poisson, &SystemRecord::jacobi>},
    {"poisson_amg_iterations", "", kLess, kFaults, iterations<&SolveRecord::poisson, &SystemRecord::amg>},
    {"elasticity_jacobi_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::elasticity, &SystemRecord::jacobi>},
    {"elasticity_amg_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::elasticity, &SystemRecord::amg>},
    {"dihedral_seconds", "s", kLess, kClock, dihedral_seconds},
    {"dihedral_cells_per_second", "1/s", kMore, kClock, dihedral_cells_per_second},
    {"poor_share_left", "", kLess, kFaults, poor_share_left},
    {"beyond_bounds_per_million", "", kLess, kFaults, beyond_bounds_per_million},
    {"conformity_proved", "", kMore, kAnswer, conformity_proved},
    {"fidelity_proved", "", kMore, kAnswer, fidelity_proved},
    {"dihedral_proved", "", kMore, kAnswer, dihedral_proved},
    {"radius_edge_proved", "", kMore, kAnswer, radius_edge_proved},
    {"boundary_angles_proved", "", kMore, kAnswer, boundary_angles_proved},
    {"topology_as_image", "", kMore, kAnswer, topology_as_image},
    {"replay_equal", "", kMore, kAnswer, replay_equal},
    {"ended", "", kMore, kOutcome, has_ended},
    {"passed", "", kMore, kOutcome, has_passed},
};

}  // namespace

std::span<const Measure> measures() { return kMeasures; }

const Measure* find_measure(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                         [&](const Measure& measure) { return measure.name == name; });
  return found == std::end(kMeasures) ? nullptr : found;
}

bool fits(const Measure& measure, Basis basis) {
  switch (measure.meaning) {
    case kClock:
      return basis == Basis::kMeasured;
    case kVirtualClock:
      return basis == Basis::kSimulated;
    case kCost:
    case kCount:
      return basis != Basis::kAny;
    default:
      return true;
  }
}

bool varies(const Measure& measure) { return measure.meaning <= kCount; }

bool varies_between_runs(const Measure& measure, const Row& row) {
  if (!varies(measure) || row.basis == Basis::kSimulated) return false;
  return measure.meaning != kCount || row.asked.value("threads", 1) > 1;
}

bool is_yes_or_no(const Measure& measure) { return measure.meaning >= kAnswer; }

}  // namespace podm::bench
