// Rows in the form that podm-bench writes, with synthetic numbers of a test.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/claim.h"
#include "trials/record.h"

namespace podm::bench {

/// Sets an option of the row's trial.
inline void ask(Row& row, const std::string& key, const Json& value) {
  Json asked = asked_of(row);
  asked[key] = value;
  row.asked = std::make_shared<const Json>(std::move(asked));
}

/// A row of status ok on a machine of two sockets of eight cores. `asked` decides whether it is simulated.
inline Row synthetic_row(const std::string& trial, const Json& asked, int repeat = 1) {
  static int num_rows = 0;
  Row row;
  row.key = "key " + std::to_string(++num_rows);
  row.experiment = "exp";
  row.trial = trial;
  row.repeat = repeat;
  row.status = Status::kOk;
  row.asked = std::make_shared<const Json>(asked.is_object() ? asked : Json::object());
  if (!row.asked->contains("threads")) ask(row, "threads", 1);
  row.basis = basis_of(*row.asked, {});
  row.command = {"podm", "mesh", "image.nii"};
  row.input.name = "image";
  row.input.path = "image.nii";
  row.programs.podm.sha256 = "build";
  row.environment.cpu = "some";
  row.environment.packages = std::uint64_t{2};
  row.environment.cores = std::uint64_t{16};
  row.environment.usable_processors = 16;
  return row;
}

/// Returns the mesher's record in a row, and creates it if absent.
inline MeshRecord& mesh_of(Row& row) {
  if (!row.mesh) row.mesh.emplace().stop_reason = kComplete;
  return *row.mesh;
}

/// A line of Table 3.
inline MemoryLevel level(const std::string& module, double cycles) {
  MemoryLevel made;
  made.module = module;
  made.cycles = cycles;
  return made;
}

inline void set_overhead(Row& row, double contention, double rollback, double begging) {
  OverheadRecord& overhead = mesh_of(row).overhead_s.emplace();
  overhead.contention = contention;
  overhead.rollback = rollback;
  overhead.begging = begging;
}

/// A synthetic row of a mesh whose refinement took `seconds`.
inline Row refined_in(double seconds, const Json& asked, int repeat = 1, const std::string& trial = "1M") {
  Row row = synthetic_row(trial, asked, repeat);
  mesh_of(row).cells = 1000;
  mesh_of(row).phases_s = {{"read", 0.5}, {"refine", seconds}};
  return row;
}

/// Returns each row of the first round in six rounds, the fewest that resolve a difference between runs.
inline std::vector<Row> in_six_rounds(const std::vector<Row>& rows) {
  std::vector<Row> made;
  for (int round = 1; round <= 6; ++round)
    for (Row row : rows) {
      row.repeat = round;
      made.push_back(std::move(row));
    }
  return made;
}

/// Reads a claim from the lines of its table. Its experiment has trials 10M, 1M and 0.1M, measured and
/// virtual, with every option that these tests name.
inline Claim read_claim_of(const std::string& lines) {
  const TomlValue table = parse_toml_text("name = 'c'\nstatement = 's'\n" + lines, "claim.toml");
  std::vector<ClaimedTrial> trials;
  for (const char* stem : {"10M", "1M", "0.1M"}) {
    for (const char* contention : {"aggressive", "random", "local"})
      for (const char* algorithm : {"podm", "pdr-podm", "auto"})
        trials.push_back(
            {stem, complete_options(
                       {{"algorithm", algorithm}, {"contention", contention}, {"threads", 1}, {"seed", 1}})});
    for (const double size : {10.0, 20.0, 40.0})
      trials.push_back(
          {stem, complete_options({{"leaf_size", size}, {"threads", 1}, {"target_elements", 5}})});
    trials.push_back({stem, complete_options({{"mesher", "other"}, {"threads", 1}})});
  }
  TomlSection section(table, "[[claims]]");
  return read_claim(section, trials);
}

}  // namespace podm::bench
