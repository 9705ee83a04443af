// Time lost by workers, memory, and accesses to memory.
#include "rows/measure_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "options/option_keys.h"

namespace podm::bench {
namespace {

Value bytes_per_cell_beyond_image(const Row& row) {
  return number_or_reason(row.process.bytes_per_cell_beyond_image, "process/bytes_per_cell_beyond_image");
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
  const std::string source = asked_of(row).value(kCounters, kPerfEvent);
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

constexpr Measure kOfLosses[] = {
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
};

}  // namespace

std::span<const Measure> measures_of_losses() { return kOfLosses; }

}  // namespace podm::bench
