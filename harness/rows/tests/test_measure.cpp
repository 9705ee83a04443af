// Tests of the numbers that claims use, each read from a row that spells them out.
#include "rows/measure.h"

#include <gtest/gtest.h>

#include "rows/codec.h"
#include "rows/series.h"
#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

// A row in which every measure has another number.
Row full_row() {
  Row row = synthetic_row("1M", {{"threads", 4}, {"target_elements", 1000}});
  row.mesh = from_json<MeshRecord>(Json::parse(R"({
    "cells": 1200, "vertices": 300, "boundary_facets": 280, "refine_cells_per_second": 300, "stop_reason": "complete",
    "phases_s": {"read": 1, "transform": 2, "allocate": 0.5, "calibrate": 50, "draw": 70, "initial": 1, "octree": 0.25,
                 "refine": 4, "closing": 0.75, "perturb": 2, "optimize": 1, "extract": 0.5, "measure": 60,
                 "write": 100},
    "perturbed": {"min_dihedral_deg": 8, "max_dihedral_deg": 165, "unmoved": {"shape": 10},
                  "before": {"with_free_vertex": 200, "without": 50},
                  "after": {"with_free_vertex": 10, "without": 40}},
    "optimization": {"least_aim_deg": 12, "largest_aim_deg": 160, "beyond_aim_before": 100, "beyond_aim": 9,
                     "beyond_bounds_before": 60, "beyond_bounds": 6, "obstacles": {}, "successes": {}},
    "virtual": {"refine_s": 0.5, "phases_s": {"read": 0.1, "refine": 0.5, "extract": 0.125, "octree": 0.025},
                "worker_s": {"compute": 3, "contention": 1.5, "begging": 2, "between_attempts": 0.5, "locks": 1}},
    "topology": {"labels": 3, "components_as_image": 3, "euler_as_image": 2},
    "lines": {"traced_mm": 200, "kept_mm": 190, "share_kept": 0.95, "arcs": 7},
    "thin_layers": {"differences": [{"kind": "lost", "label": 4}, {"kind": "joined", "label": 5}]},
    "line_distances": {"lines_delta_mm": 2, "line_edges": 90, "length_mm": 180,
                       "image_to_mesh": {"share_near": 0.9, "furthest_mm": null},
                       "mesh_to_image": {"share_near": 0.8, "furthest_mm": 3}},
    "box_ulps_off": 1.5,
    "interface_distance_mm": 0.75,
    "overhead_s": {"contention": 0.25, "begging": 7, "rollback": 0.125},
    "outcomes": {"out_of_leaf": 11},
    "hops": [60, 30, 10],
    "hops_by_kind": {"mesh_reads": [60, 30, 10], "mesh_writes": [40, 0, 60]},
    "counters": {"insertions": {"R1": 300, "R2": 100}},
    "guarantees": {"radius_edge": 2, "facet_angle": 1},
    "verdicts": {"structure": "pass", "radius_edge": "pass", "boundary_angles": "fail", "conformity": "pass", "labels": "fail", "fidelity": "not_run",
                 "dihedral": "pass", "lines": "pass", "box": "pass", "topology": "fail"}
  })"));
  row.process.counters = {{"llc_load_misses", Counter{3000UL, "s", {}}},
                          {"llc_store_misses", Counter{1000UL, "s", {}}}};
  row.measured.emplace().memory_levels = {level("L1 cache", 4),
                                          level("L2 cache", 12),
                                          level("L3 cache", 60),
                                          level("memory of the own node 0", 240),
                                          level("memory of another node 1", 480),
                                          level("memory of another node 2", 360)};
  row.resolved.emplace().cells = 1000;
  row.process.bytes_per_cell_beyond_image = 130;
  row.replay = {Replay::End::kEqual, ""};
  row.solve = SolveRecord{
      "s", {9, {120, 0.1, 4, 0, 1}, {12, 0.5, 1, 1, 2}}, {27, {240, 0.1, 8, 0, 3}, {24, 0.5, 1, 1, 4}}};
  row.side_by_side = {{0, 1200, {{"refine", 6.0}}, 200, {}}, {1, 1200, {{"refine", 3.0}}, 400, {}}};
  return row;
}

// A row of two ranks; the first computes for long and the second waits.
Row row_on_ranks() {
  Row row = full_row();
  row.mesh->ranks = from_json<RanksRecord>(Json::parse(R"({
    "number": 2, "imbalance": 1.5,
    "rounds": [{"deferred": 300, "update": {"inserted": 0}}, {"deferred": 0, "update": {"inserted": 40}}],
    "last_update": {"inserted": 20},
    "by_rank": [
      {"cells": 900, "store_cells": 1000, "seed_vertices": 12, "spent": {
        "transform": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "initial": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "refine": {"computing_s": 4, "waiting_s": 0, "network_s": 0},
        "later": {"computing_s": 2, "waiting_s": 0, "network_s": 0},
        "exchange": {"computing_s": 1, "waiting_s": 0, "network_s": 2},
        "extract": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "measure": {"computing_s": 50, "waiting_s": 0, "network_s": 0}}},
      {"cells": 300, "store_cells": 800, "seed_vertices": 18, "spent": {
        "transform": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "initial": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "refine": {"computing_s": 2, "waiting_s": 0, "network_s": 0},
        "later": {"computing_s": 1, "waiting_s": 0, "network_s": 0},
        "exchange": {"computing_s": 1, "waiting_s": 2.5, "network_s": 2},
        "extract": {"computing_s": 0.5, "waiting_s": 0, "network_s": 0},
        "measure": {"computing_s": 50, "waiting_s": 0, "network_s": 0}}}]})"));
  return row;
}

// Functions that remove parts of the full row.
using Take = void (*)(Row& row);
void take_mesh(Row& row) { row.mesh.reset(); }
void take_threads(Row& row) { row.asked.reset(); }
void take_phases(Row& row) { row.mesh->phases_s.clear(); }
void take_virtual(Row& row) { row.mesh->virtual_time.reset(); }
void take_worker_seconds(Row& row) { row.mesh->virtual_time->worker_s.reset(); }
void take_overhead(Row& row) { row.mesh->overhead_s.reset(); }
void take_rollback(Row& row) { row.mesh->overhead_s->rollback.reset(); }
void take_levels(Row& row) { row.measured.reset(); }
void take_own_memory(Row& row) {
  auto& levels = row.measured->memory_levels;
  levels.erase(levels.begin() + 3);
}
void take_solve(Row& row) { row.solve.reset(); }
void take_verdicts(Row& row) { row.mesh->verdicts.reset(); }

struct Expected {
  const char* name;
  double number;
  Take take;  ///< removes what the number needs; null: any row has it
};

constexpr std::pair<const char*, double> kOfRanks[] = {
    {"virtual_cells_per_second_and_rank", 50},           // 12 s until the first rank has extracted
    {"virtual_refining_cells_per_second_and_rank", 60},  // 10 s until it has refined
    {"processor_seconds", 16.5},
    {"refining_processor_seconds", 13},
    {"rounds", 2},
    {"deferred_share", 0.25},
    {"imbalance", 1.5},
    {"store_cells_per_cell", 1.5},
    {"learnt_per_vertex", 0.3},
};

TEST(Measures, OfRanksAreWhatTheTableSays) {
  for (const auto& [name, number] : kOfRanks) {
    const Measure* measure = find_measure(name);
    ASSERT_NE(measure, nullptr) << name;
    const Value value = measure->read(row_on_ranks());
    ASSERT_TRUE(value.number) << name << ": " << value.absence;
    EXPECT_DOUBLE_EQ(*value.number, number) << name;
    EXPECT_FALSE(measure->read(full_row()).number) << name << " of a row without ranks";
  }
  Row alone = row_on_ranks();
  alone.mesh->ranks->rounds.clear();
  EXPECT_FALSE(find_measure("deferred_share")->read(alone).number) << "one rank defers nothing";
  Row older = row_on_ranks();
  older.mesh->ranks->last_update.reset();
  older.mesh->ranks->by_rank.back().store_cells.reset();
  for (const char* name : {"store_cells_per_cell", "learnt_per_vertex"})
    EXPECT_FALSE(find_measure(name)->read(older).number) << name << " of a row that lacks a part of it";
  EXPECT_DOUBLE_EQ(*find_measure("virtual_refining_seconds")->read(row_on_ranks()).number, 10);
}

constexpr std::pair<const char*, double> kFromSurface[] = {
    {"volume_seconds", 4},
    {"volume_cells_per_second", 300},
};

// For a mesher that begins with a finished surface, the whole counts the surface and the volume part does
// not.
TEST(Measures, FromTheSurfaceAreWhatTheTableSays) {
  Row row = full_row();
  row.mesh->phases_s = {{"read", 1}, {"surface", 6}, {"refine", 4}, {"write", 100}};
  for (const auto& [name, number] : kFromSurface) {
    const Measure* measure = find_measure(name);
    ASSERT_NE(measure, nullptr) << name;
    EXPECT_DOUBLE_EQ(measure->read(row).number.value(), number) << name;
    EXPECT_FALSE(measure->read(full_row()).number)
        << name << " of a mesher that makes surface and volume in one";
    EXPECT_FALSE(measure->read(synthetic_row("1M", {})).number) << name << " without a mesh";
  }
  EXPECT_DOUBLE_EQ(find_measure("whole_seconds")->read(row).number.value(), 10);
  row.mesh->surface_cells = 800;
  EXPECT_DOUBLE_EQ(find_measure("volume_cells_per_second")->read(row).number.value(), 100)
      << "cells that came with the surface are none of the volume part's";
  EXPECT_DOUBLE_EQ(find_measure("whole_cells_per_second")->read(row).number.value(), 120);
}

TEST(Measures, AreWhatTheTableSays) {
  const Expected expected[] = {
      {"seconds", 10, take_mesh},            // without measuring, writing, calibration and drawing
      {"refining_seconds", 6, take_phases},  // initial, octree, refine, closing
      {"whole_seconds", 9, take_mesh},       // the same without reading
      {"whole_cells_per_second", 1200 / 9.0, take_phases},
      {"cells_per_second", 120, take_mesh},
      {"cells_per_second_and_core", 30, take_threads},
      {"refining_cells_per_second", 200, take_phases},
      {"refining_cells_per_second_and_core", 50, take_mesh},
      {"side_by_side_refining_cells_per_second", 600,
       [](Row& row) { row.side_by_side->front().phases_s.clear(); }},
      {"virtual_refining_seconds", 0.5, take_virtual},
      {"virtual_cells_per_second", 1600, [](Row& row) { row.mesh->virtual_time->phases_s.reset(); }},
      {"virtual_octree_share", 0.025 / 0.75, take_virtual},
      {"waiting_share", 0.25, take_worker_seconds},
      {"distributing_share", 0.1875, take_worker_seconds},
      {"worker_seconds_per_cell_but_distributing", 6.5 / 1200, take_worker_seconds},
      {"cells_over_one_machine", 1.2, [](Row& row) { row.resolved.reset(); }},
      {"bytes_per_cell_beyond_image", 130, [](Row& row) { row.process.bytes_per_cell_beyond_image.reset(); }},
      {"contention_seconds", 0.25, take_overhead},
      {"rollback_seconds", 0.125, take_overhead},
      {"begging_seconds", 7, take_overhead},
      {"lost_seconds", 0.375, take_rollback},
      {"deferred_operations", 11, [](Row& row) { row.mesh->outcomes.reset(); }},
      {"zero_hop_share", 0.6, [](Row& row) { row.mesh->hops.reset(); }},
      {"zero_hop_share_of_all_kinds", 0.5, [](Row& row) { row.mesh->hops_by_kind.reset(); }},
      {"last_level_misses_per_further_insertion", 4000,  // of one row: the misses
       [](Row& row) { row.process.counters.clear(); }},
      {"first_cache_cycles", 4, take_levels},
      {"least_step_between_levels", 3, take_own_memory},
      {"memory_over_last_cache", 4, take_own_memory},
      {"other_node_over_own", 1.5, take_own_memory},
      {"cells", 1200, take_mesh},
      {"boundary_facets", 280, [](Row& row) { row.mesh->boundary_facets.reset(); }},
      {"guarantee_misses", 3, take_mesh},
      {"unproved_claims", 4, take_verdicts},
      {"poisson_jacobi_iterations", 120, take_solve},
      {"poisson_amg_iterations", 12, take_solve},
      {"elasticity_jacobi_iterations", 240, take_solve},
      {"elasticity_amg_iterations", 24, take_solve},
      {"dihedral_seconds", 3, take_phases},
      {"dihedral_cells_per_second", 400, take_phases},
      {"poor_share_left", 0.05, [](Row& row) { row.mesh->perturbed.reset(); }},
      {"beyond_bounds_per_million", 5000, [](Row& row) { row.mesh->optimization.reset(); }},
      {"conformity_proved", 1, take_verdicts},
      {"dihedral_proved", 1, take_verdicts},
      {"fidelity_proved", 0, take_verdicts},
      {"radius_edge_proved", 1, take_verdicts},
      {"boundary_angles_proved", 0, take_verdicts},
      {"lines_proved", 1, take_verdicts},
      {"box_proved", 1, take_verdicts},
      {"topology_proved", 0, take_verdicts},
      {"lines_share_kept", 0.95, [](Row& row) { row.mesh->lines.reset(); }},
      {"lines_share_near", 0.8, [](Row& row) { row.mesh->line_distances.reset(); }},
      {"lines_share_found", 0.9, [](Row& row) { row.mesh->line_distances.reset(); }},
      {"box_ulps_off", 1.5, [](Row& row) { row.mesh->box_ulps_off.reset(); }},
      {"interface_distance_mm", 0.75, [](Row& row) { row.mesh->interface_distance_mm.reset(); }},
      {"topology_differences", 2, [](Row& row) { row.mesh->thin_layers.reset(); }},
      {"topology_as_image", 0, [](Row& row) { row.mesh->topology.reset(); }},
      {"replay_equal", 1, [](Row& row) { row.replay.reset(); }},
      {"ended", 1, nullptr},
      {"passed", 1, nullptr},
  };
  EXPECT_EQ(std::size(expected) + std::size(kOfRanks) + std::size(kFromSurface), measures().size())
      << "each measure of the table is listed here";
  for (const auto& [name, number, take] : expected) {
    const Measure* measure = find_measure(name);
    ASSERT_NE(measure, nullptr) << name;
    const Value value = measure->read(full_row());
    ASSERT_TRUE(value.number) << name << ": " << value.absence;
    EXPECT_DOUBLE_EQ(*value.number, number) << name;
    if (take == nullptr) continue;
    Row row = full_row();
    take(row);
    EXPECT_FALSE(measure->read(row).number) << name << " without what it needs";
    EXPECT_FALSE(measure->read(row).absence.empty()) << name;
  }
  EXPECT_EQ(find_measure("beauty"), nullptr);
}

TEST(Measures, PassOnTheRowsOwnReason) {
  Row row = full_row();
  row.mesh->hops = Unavailable{"one node"};
  row.mesh->hops_by_kind = Unavailable{"one node"};
  row.process.counters = {{"llc_load_misses", Unavailable{"no counter"}}};
  row.measured->memory_levels.resize(4);
  const auto absence = [&](const char* name) { return find_measure(name)->read(row).absence; };
  EXPECT_EQ(absence("zero_hop_share"), "unavailable: one node");
  EXPECT_EQ(absence("zero_hop_share_of_all_kinds"), "unavailable: one node");
  EXPECT_EQ(absence("last_level_misses_per_further_insertion"), "llc_load_misses: unavailable: no counter");
  EXPECT_EQ(absence("other_node_over_own"), "one NUMA node");
  row.measured->memory_levels[1].cycles = Unavailable{"no memory"};
  EXPECT_EQ(absence("first_cache_cycles"), "L2 cache: unavailable: no memory");
}

TEST(Measures, OfLikwidAreItsOwnEvents) {
  const Measure& misses = *find_measure("last_level_misses_per_further_insertion");
  Row row = full_row();  // the kernel's counters are present, too
  ask(row, "counters", "likwid:CACHE");
  EXPECT_EQ(misses.read(row).absence, "likwid:CACHE counts no misses of the last level");
  row.process.counters["likwid:CACHE"] = Unavailable{"not installed"};
  EXPECT_EQ(misses.read(row).absence, "likwid:CACHE: unavailable: not installed");
  for (const char* event : {"MEM_LOAD_RETIRED_L3_MISS", "L3_CACHE_REQ_MISS"}) {
    row.process.counters = {{event, Counter{77UL, "likwid", {}}}};
    EXPECT_EQ(misses.read(row).number, 77) << event;
  }
}

TEST(Measures, OfOneProcessAloneAreItsOwn) {
  Row row = full_row();
  row.side_by_side.reset();
  EXPECT_EQ(find_measure("side_by_side_refining_cells_per_second")->read(row).number, 200);
}

TEST(Measures, OfTrialsDistinguishFailedOnesFromUnmetOnes) {
  Row row;
  for (const auto& [status, ended, passed] : {std::tuple(Status::kOk, 1, 1),
                                              {Status::kUnmet, 1, 0},
                                              {Status::kFailed, 0, 0},
                                              {Status::kTimedOut, 0, 0}}) {
    row.status = status;
    EXPECT_EQ(find_measure("ended")->read(row).number, ended) << to_string(status);
    EXPECT_EQ(find_measure("passed")->read(row).number, passed) << to_string(status);
  }
  for (const auto end : {Replay::End::kDiffers, Replay::End::kFailed}) {
    row.replay = {end, ""};
    EXPECT_EQ(find_measure("replay_equal")->read(row).number, 0);
  }
}

TEST(Measures, OfTopologyNeedEachLabelToBeAsInTheImage) {
  const auto topology = [](std::uint64_t components, std::uint64_t euler) {
    Row row = full_row();
    row.mesh->topology = {3, components, euler};
    return *find_measure("topology_as_image")->read(row).number;
  };
  EXPECT_EQ(topology(3, 3), 1);
  EXPECT_EQ(topology(2, 3), 0);
  EXPECT_EQ(topology(3, 2), 0);
}

// Reading the image costs 1000 misses for any size; each further insertion costs 2.
TEST(Growth, LeavesOutWhatBothSizesPay) {
  std::vector<Row> rows;
  for (const std::uint64_t size : {1000, 5000, 9000}) {
    rows.push_back(full_row());
    ask(rows.back(), "target_elements", size);
    rows.back().process.counters = {{"llc_load_misses", Counter{1000 + 2 * size, "s", {}}}};
    rows.back().mesh->counters->insertions = {{"R1", size}};
  }
  const Measure& misses = *find_measure("last_level_misses_per_further_insertion");
  const Samples samples = sample({&rows[0], &rows[1], &rows[2]}, misses);
  ASSERT_EQ(samples.absence, "");
  EXPECT_DOUBLE_EQ(samples.middle(), 2);
  EXPECT_EQ(sample({&rows[1]}, misses).absence, "needs two target_elements, has one");
  rows[2].status = Status::kTimedOut;
  EXPECT_TRUE(sample({&rows[0], &rows[2]}, misses).absence.starts_with("rows failed"));
}

}  // namespace
}  // namespace podm::bench
