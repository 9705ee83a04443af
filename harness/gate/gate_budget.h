// What one thread's mesh of a phantom costs, committed in ci/gate_budgets.json: the same on every run of one
// build, so any difference is the program's.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gate/gate_mesher.h"

namespace podm::bench {

struct Budget {
  GateTrial trial;
  nlohmann::ordered_json work;     ///< as work_of()
  std::uint64_t instructions = 0;  ///< counted by callgrind
};

struct Budgets {
  std::string build;                  ///< compiler and flags that the instructions are of
  double instructions_tolerance = 0;  ///< relative
  std::vector<Budget> budgets;
  GateTrial timed;  ///< the trial that seconds are taken of
};

/// Throws InputError naming the file and the fault.
Budgets read_budgets(const std::string& path);
void write_budgets(const Budgets& budgets, const std::string& path);

/// The compiler and the flags of this build.
std::string this_build();

/// Deterministic work in a mesher's record: operations by rule, tests, cells, hash of the mesh.
nlohmann::ordered_json work_of(const nlohmann::ordered_json& record);

/// Each value that is not as committed, e.g. "conflict_tests: 130, committed 120".
std::vector<std::string> differences(const nlohmann::ordered_json& committed,
                                     const nlohmann::ordered_json& measured);

}  // namespace podm::bench
