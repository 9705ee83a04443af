#include "rows/measure.h"

#include <fmt/format.h>

#include <algorithm>

#include "rows/record.h"
#include "rows/table.h"
#include "trials/counter_tool.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

Value absent(const std::string& why) { return {{}, why}; }

// The number at a place, or the row's own words on why there is none.
Value number_or_reason(const Json& row, const char* place) {
  if (const auto number = number_at(row, place)) return {number, ""};
  const Json found = at(row, place);
  return absent(found.is_string() ? found.get<std::string>() : fmt::format("rows have no {}", place + 1));
}

Value sum_or_reason(const Json& row, const char* place) {
  if (const auto sum = sum_at(row, place)) return {sum, ""};
  const Json found = at(row, place);
  return absent(found.is_string() ? found.get<std::string>() : fmt::format("rows have no {}", place + 1));
}

Value quotient(const Value& dividend, const Value& divisor) {
  if (!dividend.number) return dividend;
  if (!divisor.number) return divisor;
  if (*divisor.number <= 0) return absent("a divisor is 0");
  return {*dividend.number / *divisor.number, ""};
}

Value cells(const Json& row) { return number_or_reason(row, "/cells"); }
Value threads(const Json& row) { return number_or_reason(row, "/asked/threads"); }

Value seconds(const Json& row) {
  return at(row, "/phases_s").is_object() ? Value{meshing_seconds(row), ""} : absent("rows have no phases_s");
}

// Of all that refining is; phases that an algorithm does not have cost nothing.
Value refining_seconds(const Json& row) {
  const Value refine = number_or_reason(row, "/phases_s/refine");
  if (!refine.number) return refine;
  double sum = *refine.number;
  for (const char* place : {"/phases_s/initial", "/phases_s/octree", "/phases_s/closing"})
    sum += number_at(row, place).value_or(0);
  return {sum, ""};
}

Value cells_per_second(const Json& row) { return quotient(cells(row), seconds(row)); }
Value cells_per_second_and_core(const Json& row) { return quotient(cells_per_second(row), threads(row)); }
Value refining_cells_per_second(const Json& row) { return quotient(cells(row), refining_seconds(row)); }
Value refining_cells_per_second_and_core(const Json& row) {
  return quotient(refining_cells_per_second(row), threads(row));
}

// Of all processes that ran at the same time; of one that ran alone, its own.
Value side_by_side_refining_cells_per_second(const Json& row) {
  const Json processes = at(row, "/side_by_side");
  if (!processes.is_array()) return refining_cells_per_second(row);
  double sum = 0;
  for (const Json& process : processes) {
    const Value rate = refining_cells_per_second(process);
    if (!rate.number) return rate;
    sum += *rate.number;
  }
  return {sum, ""};
}

Value virtual_refining_seconds(const Json& row) { return number_or_reason(row, "/virtual/refine_s"); }
Value virtual_cells_per_second(const Json& row) {
  return quotient(cells(row), virtual_refining_seconds(row));
}

Value contention_seconds(const Json& row) { return number_or_reason(row, "/overhead_s/contention"); }
Value rollback_seconds(const Json& row) { return number_or_reason(row, "/overhead_s/rollback"); }
Value begging_seconds(const Json& row) { return number_or_reason(row, "/overhead_s/begging"); }
Value lost_seconds(const Json& row) {
  const Value contention = contention_seconds(row), rollback = rollback_seconds(row);
  if (!contention.number || !rollback.number) return contention.number ? rollback : contention;
  return {*contention.number + *rollback.number, ""};
}

Value deferred_operations(const Json& row) { return number_or_reason(row, "/outcomes/out_of_leaf"); }

Value zero_hop_share(const Json& row) {
  return quotient(number_or_reason(row, at(row, "/hops").is_array() ? "/hops/0" : "/hops"),
                  sum_or_reason(row, "/hops"));
}

// Also of what Table 2 leaves out.
Value zero_hop_share_of_all_kinds(const Json& row) {
  const Json kinds = at(row, "/hops_by_kind");
  if (!kinds.is_object()) return sum_or_reason(row, "/hops_by_kind");
  double near = 0, all = 0;
  for (const auto& [kind, hops] : kinds.items()) {
    if (!hops.is_array())
      return absent(fmt::format("{}: {}", kind, hops.is_string() ? hops.get<std::string>() : "none"));
    for (const Json& visits : hops) all += visits.get<double>();
    near += hops.empty() ? 0 : hops[0].get<double>();
  }
  return quotient({near, ""}, {all, ""});
}

// Of who was asked to count alone: where likwid may not, the kernel counts in its place. Loads and stores
// together where the source tells both.
Value last_level_misses(const Json& row) {
  const Json counters = at(row, "/process/counters");
  const std::string source = at(row, "/asked").value(kCounters, kPerfEvent);
  if (const std::string why = text_in(counters, source.c_str()); !why.empty())
    return absent(fmt::format("{}: {}", source, why));
  if (source.starts_with(kLikwid)) {
    for (const char* event : {"/MEM_LOAD_RETIRED_L3_MISS/value", "/L3_CACHE_REQ_MISS/value"})
      if (const auto misses = number_at(counters, event)) return {misses, ""};
    return absent(source + " counts no misses of the last level");
  }
  if (const std::string why = text_in(counters, "llc_load_misses"); !why.empty())
    return absent("llc_load_misses: " + why);
  const Value loads = number_or_reason(row, "/process/counters/llc_load_misses/value");
  if (!loads.number) return loads;
  return {*loads.number + number_at(counters, "/llc_store_misses/value").value_or(0), ""};
}

Value insertions(const Json& row) { return sum_or_reason(row, "/counters/insertions"); }

// Cycles of a load by the caches in their order, then the own memory, then that of other nodes.
struct Levels {
  std::vector<double> caches, others;
  std::optional<double> own;
  std::string absence;
};

Levels levels_of(const Json& row) {
  Levels levels;
  const Json told = at(row, std::string("/") + kMemoryLevels);
  if (!told.is_array()) levels.absence = "rows have no memory_levels";
  for (const Json& level : told) {
    const std::string module = text_in(level, "module");
    const auto cycles = number_in(level, "cycles");
    if (!cycles) levels.absence = fmt::format("{}: {}", module, text_in(level, "cycles"));
    if (!cycles) break;
    if (module.ends_with("cache"))
      levels.caches.push_back(*cycles);
    else if (module.starts_with("memory of the own"))
      levels.own = cycles;
    else
      levels.others.push_back(*cycles);
  }
  if (levels.absence.empty() && levels.caches.empty()) levels.absence = "hwloc tells no caches";
  if (levels.absence.empty() && !levels.own) levels.absence = "rows do not tell the own memory";
  return levels;
}

Value first_cache_cycles(const Json& row) {
  const Levels levels = levels_of(row);
  return levels.absence.empty() ? Value{levels.caches.front(), ""} : absent(levels.absence);
}

Value least_step_between_levels(const Json& row) {
  Levels levels = levels_of(row);
  if (!levels.absence.empty()) return absent(levels.absence);
  levels.caches.push_back(*levels.own);
  double least = levels.caches[1] / levels.caches[0];
  for (std::size_t i = 2; i < levels.caches.size(); ++i)
    least = std::min(least, levels.caches[i] / levels.caches[i - 1]);
  return {least, ""};
}

Value memory_over_last_cache(const Json& row) {
  const Levels levels = levels_of(row);
  return levels.absence.empty() ? Value{*levels.own / levels.caches.back(), ""} : absent(levels.absence);
}

Value other_node_over_own(const Json& row) {
  const Levels levels = levels_of(row);
  if (!levels.absence.empty()) return absent(levels.absence);
  if (levels.others.empty()) return absent("one NUMA node");
  return {*std::min_element(levels.others.begin(), levels.others.end()) / *levels.own, ""};
}

Value guarantee_misses(const Json& row) { return sum_or_reason(row, "/guarantees"); }

// not_run never counts as pass.
Value unproved_claims(const Json& row) {
  const Json verdicts = at(row, "/verdicts");
  if (!verdicts.is_object() || verdicts.empty()) return absent("podm-verify did not run");
  return {static_cast<double>(std::count_if(verdicts.begin(), verdicts.end(),
                                            [](const Json& verdict) { return verdict != "pass"; })),
          ""};
}

Value yes(bool is_so) { return {is_so ? 1.0 : 0.0, ""}; }

Value proved(const Json& row, const std::string& claim) {
  const Json verdict = at(row, "/verdicts/" + claim);
  return verdict.is_string() ? yes(verdict == "pass")
                             : absent(fmt::format("podm-verify was not asked for {}", claim));
}
Value conformity_proved(const Json& row) { return proved(row, "conformity"); }
Value fidelity_proved(const Json& row) { return proved(row, "fidelity"); }

Value replay_equal(const Json& row) {
  const std::string replay = text_in(row, "replay");
  return replay.empty() ? absent("no replay was asked for") : yes(replay == "equal");
}

Value has_ended(const Json& row) { return yes(is_finished(row)); }
Value has_passed(const Json& row) { return yes(text_in(row, "status") == to_string(Status::kOk)); }

constexpr auto kLess = Better::kLess, kMore = Better::kMore;
using enum Meaning;

constexpr Measure kMeasures[] = {
    {"seconds", "s", kLess, kClock, seconds},
    {"refining_seconds", "s", kLess, kClock, refining_seconds},
    {"cells_per_second", "1/s", kMore, kClock, cells_per_second},
    {"cells_per_second_and_core", "1/s", kMore, kClock, cells_per_second_and_core},
    {"refining_cells_per_second", "1/s", kMore, kClock, refining_cells_per_second},
    {"refining_cells_per_second_and_core", "1/s", kMore, kClock, refining_cells_per_second_and_core},
    {"side_by_side_refining_cells_per_second", "1/s", kMore, kClock, side_by_side_refining_cells_per_second},
    {"virtual_refining_seconds", "s", kLess, kVirtualClock, virtual_refining_seconds},
    {"virtual_cells_per_second", "1/s", kMore, kVirtualClock, virtual_cells_per_second},
    {"contention_seconds", "s", kLess, kCost, contention_seconds},
    {"rollback_seconds", "s", kLess, kCost, rollback_seconds},
    {"begging_seconds", "s", kLess, kCost, begging_seconds},
    {"lost_seconds", "s", kLess, kCost, lost_seconds},
    {"deferred_operations", "", kLess, kCost, deferred_operations},
    {"zero_hop_share", "", kMore, kCost, zero_hop_share},
    {"zero_hop_share_of_all_kinds", "", kMore, kCost, zero_hop_share_of_all_kinds},
    {"last_level_misses_per_further_insertion", "", kLess, kCost, last_level_misses, insertions},
    {"first_cache_cycles", "cycles", kLess, kClock, first_cache_cycles},
    {"least_step_between_levels", "", kMore, kClock, least_step_between_levels},
    {"memory_over_last_cache", "", kMore, kClock, memory_over_last_cache},
    {"other_node_over_own", "", kMore, kClock, other_node_over_own},
    {"guarantee_misses", "", kLess, kFaults, guarantee_misses},
    {"unproved_claims", "", kLess, kFaults, unproved_claims},
    {"conformity_proved", "", kMore, kAnswer, conformity_proved},
    {"fidelity_proved", "", kMore, kAnswer, fidelity_proved},
    {"replay_equal", "", kMore, kAnswer, replay_equal},
    {"ended", "", kMore, kOutcome, has_ended},
    {"passed", "", kMore, kOutcome, has_passed},
};

}  // namespace

std::string to_string(Basis basis) {
  return basis == Basis::kMeasured ? "measured" : basis == Basis::kSimulated ? "simulated" : "any";
}

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
      return basis != Basis::kAny;
    default:
      return true;
  }
}

bool varies(const Measure& measure) { return measure.meaning <= kCost; }

bool is_yes_or_no(const Measure& measure) { return measure.meaning >= kAnswer; }

}  // namespace podm::bench
