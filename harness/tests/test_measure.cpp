// The numbers that claims speak of, each read from a row that spells them out.
#include "rows/measure.h"

#include <gtest/gtest.h>

#include "made_up_rows.h"
#include "rows/series.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

// A row in which every measure has another number.
Json full_row() {
  return Json::parse(R"({
    "trial": "1M", "repeat": 1, "status": "ok", "reason": "",
    "asked": {"threads": 4, "target_elements": 1000},
    "cells": 1200,
    "phases_s": {"read": 1, "transform": 2, "allocate": 0.5, "calibrate": 50, "draw": 70, "initial": 1, "octree": 0.25,
                 "refine": 4, "closing": 0.75, "extract": 0.5, "measure": 60, "write": 100},
    "virtual": {"refine_s": 0.5},
    "overhead_s": {"contention": 0.25, "begging": 7, "rollback": 0.125},
    "outcomes": {"out_of_leaf": 11},
    "hops": [60, 30, 10],
    "hops_by_kind": {"mesh_reads": [60, 30, 10], "mesh_writes": [40, 0, 60]},
    "process": {"counters": {"llc_load_misses": {"value": 3000, "source": "s"},
                             "llc_store_misses": {"value": 1000, "source": "s"}}},
    "counters": {"insertions": {"R1": 300, "R2": 100}},
    "memory_levels": [{"module": "L1 cache", "cycles": 4}, {"module": "L2 cache", "cycles": 12},
                      {"module": "L3 cache", "cycles": 60}, {"module": "memory of the own node 0", "cycles": 240},
                      {"module": "memory of another node 1", "cycles": 480},
                      {"module": "memory of another node 2", "cycles": 360}],
    "guarantees": {"radius_edge": 2, "facet_angle": 1},
    "verdicts": {"structure": "pass", "conformity": "pass", "labels": "fail", "fidelity": "not_run"},
    "replay": "equal",
    "side_by_side": [{"cells": 1200, "phases_s": {"refine": 6}}, {"cells": 1200, "phases_s": {"refine": 3}}]
  })");
}

struct Expected {
  const char* name;
  double number;
  const char* needs;  ///< a place in the row without which there is no number
};

TEST(Measures, AreWhatTheTableSays) {
  const Expected expected[] = {
      {"seconds", 10, "/phases_s"},          // without measuring, writing, calibration and drawing
      {"refining_seconds", 6, "/phases_s"},  // initial, octree, refine, closing
      {"cells_per_second", 120, "/cells"},
      {"cells_per_second_and_core", 30, "/asked/threads"},
      {"refining_cells_per_second", 200, "/phases_s/refine"},
      {"refining_cells_per_second_and_core", 50, "/cells"},
      {"side_by_side_refining_cells_per_second", 600, "/side_by_side/0/cells"},
      {"virtual_refining_seconds", 0.5, "/virtual"},
      {"virtual_cells_per_second", 2400, "/virtual"},
      {"contention_seconds", 0.25, "/overhead_s"},
      {"rollback_seconds", 0.125, "/overhead_s"},
      {"begging_seconds", 7, "/overhead_s"},
      {"lost_seconds", 0.375, "/overhead_s/rollback"},
      {"deferred_operations", 11, "/outcomes"},
      {"zero_hop_share", 0.6, "/hops"},
      {"zero_hop_share_of_all_kinds", 0.5, "/hops_by_kind"},
      {"last_level_misses_per_further_insertion", 4000, "/process"},  // of one row: the misses
      {"first_cache_cycles", 4, "/memory_levels"},
      {"least_step_between_levels", 3, "/memory_levels/3"},
      {"memory_over_last_cache", 4, "/memory_levels/3"},
      {"other_node_over_own", 1.5, "/memory_levels/3"},
      {"guarantee_misses", 3, "/guarantees"},
      {"unproved_claims", 2, "/verdicts"},
      {"conformity_proved", 1, "/verdicts/conformity"},
      {"fidelity_proved", 0, "/verdicts/fidelity"},
      {"replay_equal", 1, "/replay"},
      {"ended", 1, nullptr},
      {"passed", 1, nullptr},
  };
  EXPECT_EQ(std::size(expected), measures().size()) << "each measure of the table is told here";
  for (const auto& [name, number, needs] : expected) {
    const Measure* measure = find_measure(name);
    ASSERT_NE(measure, nullptr) << name;
    const Value value = measure->read(full_row());
    ASSERT_TRUE(value.number) << name << ": " << value.absence;
    EXPECT_DOUBLE_EQ(*value.number, number) << name;
    if (needs == nullptr) continue;
    Json row = full_row();
    const Json::json_pointer place(needs);
    row[place.parent_pointer()].is_array()
        ? static_cast<void>(row[place.parent_pointer()].erase(std::stoul(place.back())))
        : static_cast<void>(row[place.parent_pointer()].erase(place.back()));
    EXPECT_FALSE(measure->read(row).number) << name << " without " << needs;
    EXPECT_FALSE(measure->read(row).absence.empty()) << name;
  }
  EXPECT_EQ(find_measure("beauty"), nullptr);
}

TEST(Measures, PassOnTheRowsOwnReason) {
  Json row = full_row();
  row["hops"] = row["hops_by_kind"] = "unavailable: one node";
  row["process"]["counters"] = {{"llc_load_misses", "unavailable: no counter"}};
  row["memory_levels"].erase(4);
  row["memory_levels"].erase(4);
  const auto absence = [&](const char* name) { return find_measure(name)->read(row).absence; };
  EXPECT_EQ(absence("zero_hop_share"), "unavailable: one node");
  EXPECT_EQ(absence("zero_hop_share_of_all_kinds"), "unavailable: one node");
  EXPECT_EQ(absence("last_level_misses_per_further_insertion"), "llc_load_misses: unavailable: no counter");
  EXPECT_EQ(absence("other_node_over_own"), "one NUMA node");
  row["memory_levels"][1]["cycles"] = "unavailable: no memory";
  EXPECT_EQ(absence("first_cache_cycles"), "L2 cache: unavailable: no memory");
}

TEST(Measures, OfLikwidAreItsEventsAndNobodyElses) {
  const Measure& misses = *find_measure("last_level_misses_per_further_insertion");
  Json row = full_row();  // the kernel's counters are there too
  row["asked"]["counters"] = "likwid:CACHE";
  EXPECT_EQ(misses.read(row).absence, "likwid:CACHE counts no misses of the last level");
  row["process"]["counters"]["likwid:CACHE"] = "unavailable: not installed";
  EXPECT_EQ(misses.read(row).absence, "likwid:CACHE: unavailable: not installed");
  for (const char* event : {"MEM_LOAD_RETIRED_L3_MISS", "L3_CACHE_REQ_MISS"}) {
    row["process"]["counters"] = {{event, {{"value", 77}, {"source", "likwid"}}}};
    EXPECT_EQ(misses.read(row).number, 77) << event;
  }
}

TEST(Measures, OfOneProcessAloneAreItsOwn) {
  Json row = full_row();
  row["side_by_side"] = nullptr;
  EXPECT_EQ(find_measure("side_by_side_refining_cells_per_second")->read(row).number, 200);
}

TEST(Measures, OfTrialsTellFailedOnesFromUnmetOnes) {
  for (const auto& [status, ended, passed] :
       {std::tuple("ok", 1, 1), {"unmet", 1, 0}, {"failed", 0, 0}, {"timed_out", 0, 0}}) {
    const Json row{{"status", status}};
    EXPECT_EQ(find_measure("ended")->read(row).number, ended) << status;
    EXPECT_EQ(find_measure("passed")->read(row).number, passed) << status;
  }
  EXPECT_EQ(find_measure("replay_equal")->read({{"replay", "differs"}}).number, 0);
  EXPECT_EQ(find_measure("replay_equal")->read({{"replay", "failed: no log"}}).number, 0);
}

// Reading the image costs 1000 misses whatever the size; a further insertion 2.
TEST(Growth, LeavesOutWhatBothSizesPay) {
  std::vector<Json> rows;
  for (const int size : {1000, 5000, 9000}) {
    rows.push_back(full_row());
    rows.back()["asked"]["target_elements"] = size;
    rows.back()["process"]["counters"] = {{"llc_load_misses", {{"value", 1000 + 2 * size}}}};
    rows.back()["counters"]["insertions"] = {{"R1", size}};
  }
  const Measure& misses = *find_measure("last_level_misses_per_further_insertion");
  const Samples samples = sample({&rows[0], &rows[1], &rows[2]}, misses);
  ASSERT_EQ(samples.absence, "");
  EXPECT_DOUBLE_EQ(samples.middle(), 2);
  EXPECT_EQ(sample({&rows[1]}, misses).absence, "needs two target_elements, has one");
  rows[2]["status"] = "timed_out";
  EXPECT_TRUE(sample({&rows[0], &rows[2]}, misses).absence.starts_with("rows failed"));
}

}  // namespace
}  // namespace podm::bench
