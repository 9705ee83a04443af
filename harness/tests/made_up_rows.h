// Rows as podm-bench would have written them, of numbers that a test makes up.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/claim.h"
#include "rows/record.h"

namespace podm::bench {

/// A row of status ok on a machine of two sockets of eight cores. `asked` decides whether it is simulated.
inline nlohmann::ordered_json made_up_row(const std::string& trial, const nlohmann::ordered_json& asked,
                                          int repeat = 1) {
  static int num_rows = 0;
  using Json = nlohmann::ordered_json;
  Json options = asked;
  if (!options.contains("threads")) options["threads"] = 1;
  return {{"key", "key " + std::to_string(++num_rows)},
          {"trial", trial},
          {"repeat", repeat},
          {"warmup", false},
          {"status", "ok"},
          {"reason", ""},
          {"asked", options},
          {"basis", basis_of(options, Json::object())},
          {"input", {{"name", "image"}, {"path", "image.nii"}}},
          {"environment", {{"cpu", "some"}, {"packages", 2}, {"cores", 16}, {"usable_processors", 16}}},
          {"programs", {{"podm", {{"sha256", "build"}}}}}};
}

/// The same where refinement took so many seconds.
inline nlohmann::ordered_json refined_in(double seconds, const nlohmann::ordered_json& asked, int repeat = 1,
                                         const std::string& trial = "1M") {
  nlohmann::ordered_json row = made_up_row(trial, asked, repeat);
  row["cells"] = 1000;
  row["phases_s"] = {{"read", 0.5}, {"refine", seconds}};
  return row;
}

/// A claim read from the lines of its table. Its experiment has trials 10M, 1M and 0.1M, measured and virtual
/// ones of every option that these tests name.
inline Claim read_claim_of(const std::string& lines) {
  const toml::table table = toml::parse("name = 'c'\nstatement = 's'\n" + lines);
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
  Section section("claim.toml", table, "[[claims]]");
  return read_claim(section, trials);
}

}  // namespace podm::bench
