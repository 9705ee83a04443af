// Tests every claim of every experiment in experiments/ with rows synthesized from the claim's own form: rows
// that satisfy it, rows that break it, and rows that decide nothing. test_judge.cpp tests the kinds of
// claims, test_measure.cpp the measures.
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "experiments/claim_names.h"
#include "experiments/judge.h"
#include "options/option_matrix.h"
#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

using Rows = std::vector<Row>;

constexpr double kMuch = 1e6;  // keeps small differences of counts, which are integers

std::uint64_t many(double value) { return static_cast<std::uint64_t>(std::llround(kMuch * value)); }

void set_levels(Row& row, double first, double second, double own, double other) {
  row.measured.emplace().memory_levels = {level("L1 cache", first), level("L2 cache", second),
                                          level("memory of the own node 0", own),
                                          level("memory of another node 1", other)};
}

void set_rate(Row& row, double cells_per_second) {
  mesh_of(row).cells = many(cells_per_second);
  mesh_of(row).phases_s = {{"refine", kMuch}};
}

void set_unproved(Row& row, double number) {
  ByName<Proof>& verdicts = mesh_of(row).verdicts.emplace();
  verdicts["structure"] = Proof::kPass;
  for (int i = 0; i < number; ++i)
    verdicts["claim " + std::to_string(i)] = i == 0 ? Proof::kFail : Proof::kNotRun;
}

void set_proof(Row& row, const std::string& claim, Proof proof) { mesh_of(row).verdicts = {{claim, proof}}; }

void set_misses_per_insertion(Row& row, double value) {
  const double size = asked_of(row).at("target_elements");
  const bool is_likwid = asked_of(row).value("counters", "").starts_with("likwid");
  mesh_of(row).counters.emplace().insertions = {{"R1", static_cast<std::uint64_t>(size)}};
  row.process.counters = {
      {is_likwid ? "MEM_LOAD_RETIRED_L3_MISS" : "llc_load_misses", Counter{value * size, "s", {}}}};
}

RanksRecord& ranks_of(Row& row) {
  RanksRecord& ranks = mesh_of(row).ranks.emplace();
  ranks.number = asked_of(row).value("ranks", 1);
  return ranks;
}

void set_seconds_of_rank(Row& row, double computing_s) {
  RankRecord& rank = ranks_of(row).by_rank.emplace_back();
  rank.spent["refine"].computing_s = computing_s;
}

void set_rate_of_rank(Row& row, double cells_per_second) {
  set_seconds_of_rank(row, kMuch);
  mesh_of(row).cells = many(cells_per_second * static_cast<double>(mesh_of(row).ranks->number));
}

using SetValue = void (*)(Row& row, double value);

const std::map<std::string, SetValue> kSetters = {
    {"seconds",
     [](Row& row, double value) {
       mesh_of(row).phases_s = {{"refine", value}};
     }},
    {"refining_seconds",
     [](Row& row, double value) {
       mesh_of(row).phases_s = {{"refine", value}};
     }},
    {"cells",  // in millions, because they are integers; ratios are kept
     [](Row& row, double value) {
       mesh_of(row).cells = static_cast<std::uint64_t>(std::llround(1e6 * value));
     }},
    {"boundary_facets",
     [](Row& row, double value) {
       mesh_of(row).boundary_facets = static_cast<std::uint64_t>(std::llround(1e6 * value));
     }},
    {"whole_cells_per_second", set_rate},
    {"volume_cells_per_second",
     [](Row& row, double value) {
       set_rate(row, value);
       mesh_of(row).phases_s.emplace_back("surface", kMuch);
     }},
    {"cells_per_second", set_rate},
    {"cells_per_second_and_core",
     [](Row& row, double value) { set_rate(row, value * asked_of(row).at("threads").get<double>()); }},
    {"refining_cells_per_second", set_rate},
    {"refining_cells_per_second_and_core",
     [](Row& row, double value) { set_rate(row, value * asked_of(row).at("threads").get<double>()); }},
    {"side_by_side_refining_cells_per_second", set_rate},
    {"virtual_refining_seconds",
     [](Row& row, double value) { mesh_of(row).virtual_time.emplace().refine_s = value; }},
    {"virtual_cells_per_second",
     [](Row& row, double value) {
       mesh_of(row).cells = many(value);
       mesh_of(row).virtual_time.emplace().phases_s = {{"refine", kMuch}};
     }},
    {"virtual_octree_share",
     [](Row& row, double value) {
       mesh_of(row).virtual_time.emplace().phases_s = {{"octree", value}, {"refine", 1 - value}};
     }},
    {"waiting_share",
     [](Row& row, double value) {
       mesh_of(row).virtual_time.emplace().worker_s = {{"begging", value}, {"compute", 1 - value}};
     }},
    {"distributing_share",
     [](Row& row, double value) {
       mesh_of(row).virtual_time.emplace().worker_s = {{"between_attempts", value}, {"compute", 1 - value}};
     }},
    {"worker_seconds_per_cell_but_distributing",
     [](Row& row, double value) {
       mesh_of(row).cells = many(1);
       mesh_of(row).virtual_time.emplace().worker_s = {{"compute", kMuch * value}, {"locks", 1}};
     }},
    {"virtual_cells_per_second_and_rank", set_rate_of_rank},
    {"virtual_refining_cells_per_second_and_rank", set_rate_of_rank},
    {"processor_seconds", set_seconds_of_rank},
    {"refining_processor_seconds", set_seconds_of_rank},
    {"rounds",
     [](Row& row, double value) { ranks_of(row).rounds.resize(static_cast<std::size_t>(std::ceil(value))); }},
    {"deferred_share",
     [](Row& row, double value) {
       mesh_of(row).cells = many(1);
       ranks_of(row).rounds.emplace_back().deferred = many(value);
     }},
    {"imbalance", [](Row& row, double value) { ranks_of(row).imbalance = value; }},
    {"store_cells_per_cell",
     [](Row& row, double value) {
       mesh_of(row).cells = many(1);
       ranks_of(row).by_rank.emplace_back().store_cells = many(value);
     }},
    {"learnt_per_vertex",
     [](Row& row, double value) {
       mesh_of(row).vertices = many(1);
       ranks_of(row).last_update.emplace().inserted = many(value);
     }},
    {"cells_over_one_machine",
     [](Row& row, double value) {
       row.resolved.emplace().cells = many(1);
       mesh_of(row).cells = many(value);
     }},
    {"bytes_per_cell_beyond_image",
     [](Row& row, double value) {
       mesh_of(row);
       row.process.bytes_per_cell_beyond_image = value;
     }},
    {"dihedral_seconds",
     [](Row& row, double value) {
       mesh_of(row).phases_s = {{"perturb", value}};
     }},
    {"dihedral_cells_per_second",
     [](Row& row, double value) {
       mesh_of(row).cells = many(value);
       mesh_of(row).phases_s = {{"perturb", kMuch}};
     }},
    {"poor_share_left",
     [](Row& row, double value) {
       PerturbedRecord& perturbed = mesh_of(row).perturbed.emplace();
       perturbed.before.with_free_vertex = many(1);
       perturbed.after.with_free_vertex = many(value);
     }},
    {"beyond_bounds_per_million",
     [](Row& row, double value) {
       mesh_of(row).cells = many(1);
       mesh_of(row).optimization.emplace().beyond_bounds = many(value / 1e6);
     }},
    {"lost_seconds", [](Row& row, double value) { set_overhead(row, value, 0, 0); }},
    {"contention_seconds", [](Row& row, double value) { set_overhead(row, value, 0, 0); }},
    {"rollback_seconds", [](Row& row, double value) { set_overhead(row, 0, value, 0); }},
    {"begging_seconds", [](Row& row, double value) { set_overhead(row, 0, 0, value); }},
    {"deferred_operations",
     [](Row& row, double value) { mesh_of(row).outcomes.emplace().out_of_leaf = many(value); }},
    {"zero_hop_share",
     [](Row& row, double value) {
       mesh_of(row).hops = std::vector{many(value), many(1 - value)};
     }},
    {"zero_hop_share_of_all_kinds",
     [](Row& row, double value) {
       mesh_of(row).hops_by_kind = ByName<Hops>{{"mesh_reads", std::vector{many(value), many(1 - value)}}};
     }},
    {"last_level_misses_per_further_insertion", set_misses_per_insertion},
    {"first_cache_cycles", [](Row& row, double value) { set_levels(row, value, 100, 1000, 2000); }},
    {"least_step_between_levels",
     [](Row& row, double value) { set_levels(row, 100, 100 * value, 100 * value * value, 5000); }},
    {"memory_over_last_cache", [](Row& row, double value) { set_levels(row, 4, 100, 100 * value, 5000); }},
    {"other_node_over_own", [](Row& row, double value) { set_levels(row, 4, 10, 100, 100 * value); }},
    {"guarantee_misses",
     [](Row& row, double value) {
       mesh_of(row).guarantees = {{"radius_edge", static_cast<std::uint64_t>(value)}};
     }},
    {"unproved_claims", set_unproved},
    {"conformity_proved",
     [](Row& row, double value) { set_proof(row, "conformity", value == 1 ? Proof::kPass : Proof::kFail); }},
    {"fidelity_proved",
     [](Row& row, double value) { set_proof(row, "fidelity", value == 1 ? Proof::kPass : Proof::kNotRun); }},
    {"dihedral_proved",
     [](Row& row, double value) { set_proof(row, "dihedral", value == 1 ? Proof::kPass : Proof::kNotRun); }},
    {"box_proved",
     [](Row& row, double value) { set_proof(row, "box", value == 1 ? Proof::kPass : Proof::kNotRun); }},
    {"topology_proved",
     [](Row& row, double value) { set_proof(row, "topology", value == 1 ? Proof::kPass : Proof::kFail); }},
    {"lines_share_kept", [](Row& row, double value) { mesh_of(row).lines.emplace().share_kept = value; }},
    {"lines_share_near",
     [](Row& row, double value) {
       LineDistancesRecord& lines = mesh_of(row).line_distances.emplace();
       lines.image_to_mesh.share_near = 1;
       lines.mesh_to_image.share_near = value;
     }},
    {"lines_share_found",
     [](Row& row, double value) { mesh_of(row).line_distances.emplace().image_to_mesh.share_near = value; }},
    {"box_ulps_off", [](Row& row, double value) { mesh_of(row).box_ulps_off = value; }},
    {"interface_distance_mm", [](Row& row, double value) { mesh_of(row).interface_distance_mm = value; }},
    {"topology_differences",
     [](Row& row, double value) {
       mesh_of(row).thin_layers.emplace().differences.resize(static_cast<std::size_t>(std::ceil(value)));
     }},
    {"radius_edge_proved",
     [](Row& row, double value) { set_proof(row, "radius_edge", value == 1 ? Proof::kPass : Proof::kFail); }},
    {"boundary_angles_proved",
     [](Row& row, double value) {
       set_proof(row, "boundary_angles", value == 1 ? Proof::kPass : Proof::kFail);
     }},
    {"topology_as_image",
     [](Row& row, double value) {
       mesh_of(row).topology = {2, 2, value == 1 ? 2UL : 1UL};
     }},
    {"poisson_jacobi_iterations",
     [](Row& row, double value) {
       mesh_of(row);
       row.solve.emplace().poisson.jacobi.iterations = many(value);
     }},
    {"elasticity_jacobi_iterations",
     [](Row& row, double value) {
       mesh_of(row);
       row.solve.emplace().elasticity.jacobi.iterations = many(value);
     }},
    {"replay_equal",
     [](Row& row, double value) {
       row.replay = {value == 1 ? Replay::End::kEqual : Replay::End::kDiffers, ""};
     }},
    {"ended", [](Row& row, double value) { row.status = value == 1 ? Status::kUnmet : Status::kTimedOut; }},
    {"passed", [](Row& row, double value) { row.status = value == 1 ? Status::kOk : Status::kUnmet; }},
};

// Sets the row's measure to `value`.
void set_value(Row& row, const std::string& measure, double value) {
  const auto setter = kSetters.find(measure);
  ASSERT_NE(setter, kSetters.end()) << "this test does not know how to make rows of " << measure;
  setter->second(row, value);
}

// Returns rows of the first trials of the claim, with several numbers of threads if they depend on the
// machine.
Rows rows_of(const Experiment& experiment, const Claim& claim) {
  Rows rows;
  const std::string pattern = claim.trials.empty() ? "*" : claim.trials.front();
  for (const Trial& trial : experiment.trials) {
    if (fnmatch(pattern.c_str(), stem_of(trial.name).c_str(), 0) != 0) continue;
    std::vector<Json> asked{trial.options};
    const char* number = trial.options.contains("copies") ? "copies" : "threads";
    for (const int processors : {1, 2, 4, 8}) {
      asked.push_back(trial.options);
      asked.back()[number] = processors;
    }
    for (const Json& options : asked) {
      rows.push_back(synthetic_row(trial.name, options));
      rows.back().input.name = trial.image;
      const int cores = std::max(claim.needs_cores, 16);
      rows.back().environment.packages = std::uint64_t{1};
      rows.back().environment.cores = static_cast<std::uint64_t>(cores);
      rows.back().environment.usable_processors = cores;
    }
  }
  return in_six_rounds(rows);
}

// Returns the value of a row for which the claim's ratio, bound or factor is `value`.
double value_of(const Claim& claim, const Row& row, double value) {
  const Json options = options_of(row);
  if (claim.kind == ClaimKind::kTrend) {
    const Json place = option(options, claim.along);
    if (!place.is_number()) return 1;  // not part of the trend
    return std::pow(value, (claim.grows ? 1 : -1) * std::log2(place.get<double>()));
  }
  if (claim.kind != ClaimKind::kRatio && claim.kind != ClaimKind::kOrder) return value;
  const bool is_over = claim.over_best ? !matches(options, claim.of) : matches(options, claim.over);
  return is_over ? 0.5 : matches(options, claim.of) ? 0.5 * value : 0.25;
}

Rows with_value(const Claim& claim, Rows rows, double value) {
  for (Row& row : rows) set_value(row, claim.value->name, value_of(claim, row, value));
  return rows;
}

double within(const Claim& claim) {
  switch (claim.kind) {
    case ClaimKind::kOrder:
      return 1.01;
    case ClaimKind::kTrend:
      return 1.01 * std::max(1.0, claim.factor_per_doubling);
    default:
      return claim.at_least && claim.at_most ? (*claim.at_least + *claim.at_most) / 2
             : claim.at_least                ? *claim.at_least
                                             : *claim.at_most;
  }
}

// Values just beyond the bounds.
std::vector<double> beyond(const Claim& claim) {
  if (claim.kind == ClaimKind::kOrder) return {1, 0.99};
  if (claim.kind == ClaimKind::kTrend) return {0.99 * std::max(1.0, claim.factor_per_doubling)};
  if (is_yes_or_no(*claim.value)) return {0};
  std::vector<double> values;
  if (claim.at_least) values.push_back(0.99 * *claim.at_least);
  if (claim.at_most) values.push_back(varies(*claim.value) ? 1.01 * *claim.at_most : *claim.at_most + 1);
  return values;
}

std::string describe(const Judgement& judgement) {
  return to_string(judgement.verdict) + ": " + judgement.reason;
}

void expect_open(const Claim& claim, const Rows& rows, const std::string& why) {
  const Judgement judgement = judge(claim, rows);
  EXPECT_EQ(judgement.verdict, Verdict::kCannotBeDecided) << why << ": " << describe(judgement);
  EXPECT_FALSE(judgement.value) << why;
  EXPECT_NE(judgement.reason, "") << why;
}

void expect_either_way(const Experiment& experiment, const Claim& claim) {
  const Rows rows = rows_of(experiment, claim), fine = with_value(claim, rows, within(claim));
  EXPECT_EQ(judge(claim, fine).verdict, Verdict::kHolds) << describe(judge(claim, fine));
  for (const double value : beyond(claim)) {
    const Judgement judgement = judge(claim, with_value(claim, rows, value));
    EXPECT_EQ(judgement.verdict, Verdict::kDoesNotHold) << "by " << value << ": " << describe(judgement);
  }
}

Rows with_status(Rows rows, Status status) {
  for (Row& row : rows) row.status = status;
  return rows;
}

void expect_undecided(const Experiment& experiment, const Claim& claim) {
  const Rows fine = with_value(claim, rows_of(experiment, claim), within(claim));
  expect_open(claim, {}, "without rows");
  expect_open(claim, with_status(fine, Status::kSkipped), "skipped");
  if (claim.value->meaning != Meaning::kOutcome)
    expect_open(claim, with_status(fine, Status::kFailed), "failed");
  if (claim.basis != Basis::kAny) {
    Rows other = fine;
    for (Row& row : other) row.basis = claim.basis == Basis::kMeasured ? Basis::kSimulated : Basis::kMeasured;
    expect_open(claim, other, "of another basis");
  }
  Rows lonely = fine;  // a series without its counterpart
  std::erase_if(lonely, [&](const Row& row) { return matches(options_of(row), claim.of); });
  if (!claim.of.empty() && !names(claim.over, "threads")) expect_open(claim, lonely, "without a series");
  Rows small = fine;
  for (Row& row : small)
    row.environment.cores = static_cast<std::uint64_t>(std::max(0, claim.needs_cores - 1));
  if (claim.needs_cores > 0) expect_open(claim, small, "on a small machine");
}

TEST(ExperimentClaims, TurnEitherWayOrAreLeftOpen) {
  for (const std::string& path : experiment_files(PODM_EXPERIMENTS)) {
    const Experiment experiment = read_experiment(path);
    ASSERT_FALSE(experiment.claims.empty()) << path;
    for (const Claim& claim : experiment.claims) {
      SCOPED_TRACE(path + ": " + claim.name);
      expect_either_way(experiment, claim);
      expect_undecided(experiment, claim);
    }
  }
}

TEST(ExperimentClaims, HaveNamesOfTheirOwn) {
  std::vector<Experiment> experiments;
  for (const std::string& path : experiment_files(PODM_EXPERIMENTS))
    experiments.push_back(read_experiment(path));
  EXPECT_NO_THROW(check_claim_names(experiments));
  experiments.push_back(experiments.front());
  EXPECT_THROW(check_claim_names(experiments), InputError);
}

// Published failures are claims, so that verdicts show them.
TEST(ExperimentClaims, StateWhatFailedWithItsReason) {
  const std::pair<const char*, const char*> published[] = {
      {"contention", "local-loses-least"},
      {"simulated_weak", "pdr-podm-on-several-blades"},
      {"initial_mesh", "ratio-4"},
  };
  for (const auto& [name, claimed] : published) {
    const Experiment experiment = read_experiment(std::string(PODM_EXPERIMENTS) + "/" + name + ".toml");
    const auto claim = std::find_if(experiment.claims.begin(), experiment.claims.end(),
                                    [&](const Claim& one) { return one.name == claimed; });
    ASSERT_NE(claim, experiment.claims.end()) << claimed;
    EXPECT_NE(claim->note, "") << claimed;
  }
}

}  // namespace
}  // namespace podm::bench
