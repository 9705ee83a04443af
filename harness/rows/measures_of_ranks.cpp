// Virtual time, and the work of ranks.
#include "rows/measure_parts.h"

#include <algorithm>
#include <array>

namespace podm::bench {
namespace {

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
template <class Read>
Value from_ranks(const Row& row, const Read& read) {
  const auto* const ranks = ranks_of(row);
  return ranks == nullptr ? no_ranks() : Value{static_cast<double>(read(*ranks)), ""};
}

// Returns the sum over all ranks, for the phases that `is_counted` selects.
double processor_seconds_of(const RanksRecord& ranks, bool (*is_counted)(const std::string& phase)) {
  double sum = 0;
  for (const RankRecord& rank : ranks.by_rank)
    for (const auto& [phase, spent] : rank.spent)
      if (is_counted(phase)) sum += spent.computing_s;
  return sum;
}
Value processor_seconds(const Row& row) {
  return from_ranks(row, [](const RanksRecord& ranks) { return processor_seconds_of(ranks, is_meshing); });
}
Value refining_processor_seconds(const Row& row) {
  return from_ranks(row, [](const RanksRecord& ranks) { return processor_seconds_of(ranks, is_refining); });
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
  return from_ranks(row, [](const RanksRecord& ranks) { return ranks.number; });
}
Value rounds(const Row& row) {
  return from_ranks(row, [](const RanksRecord& ranks) { return ranks.rounds.size(); });
}
Value imbalance(const Row& row) {
  return from_ranks(row, [](const RanksRecord& ranks) { return ranks.imbalance; });
}
Value deferred_share(const Row& row) {
  const auto* const ranks = ranks_of(row);
  if (ranks == nullptr) return no_ranks();
  if (ranks->rounds.empty()) return absent("one rank has no rounds");
  return quotient({static_cast<double>(ranks->rounds.front().deferred), ""}, cells(row));
}
Value store_cells_per_cell(const Row& row) {
  const auto* const ranks = ranks_of(row);
  if (ranks == nullptr) return no_ranks();
  double sum = 0;
  for (const RankRecord& rank : ranks->by_rank) {
    if (!rank.store_cells) return absent("rows have no ranks/by_rank/store_cells");
    sum += static_cast<double>(*rank.store_cells);
  }
  return quotient({sum, ""}, cells(row));
}
Value learnt_per_vertex(const Row& row) {
  const auto* const ranks = ranks_of(row);
  if (ranks == nullptr) return no_ranks();
  if (!ranks->last_update) return absent("rows have no ranks/last_update");
  auto learnt = static_cast<double>(ranks->last_update->inserted);
  for (const RankRecord& rank : ranks->by_rank) learnt += static_cast<double>(rank.seed_vertices.value_or(0));
  for (const RoundRecord& round : ranks->rounds)
    learnt += round.update ? static_cast<double>(round.update->inserted) : 0;
  return quotient({learnt, ""}, {static_cast<double>(row.mesh->vertices), ""});
}
Value cells_over_one_machine(const Row& row) {
  if (!row.resolved) return absent("rows have no resolved");
  return quotient(cells(row), {static_cast<double>(row.resolved->cells), ""});
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

constexpr Measure kOfRanks[] = {
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
    {"store_cells_per_cell", "", kLess, kCount, store_cells_per_cell},
    {"learnt_per_vertex", "", kLess, kCount, learnt_per_vertex},
    {"cells_over_one_machine", "", kLess, kCount, cells_over_one_machine},
};

}  // namespace

std::span<const Measure> measures_of_ranks() { return kOfRanks; }

}  // namespace podm::bench
