// The cost of a phantom's mesh on one thread, committed in ci/gate_budgets.json. It is the same on every run
// of one build; any difference is therefore the program's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gate/gate_mesher.h"

namespace podm::bench {

/// Work and result of one thread's mesh, in values that each run repeats exactly.
struct Work : WorkRecord {
  std::optional<std::uint64_t> cells, vertices;
  std::optional<std::string> mesh_sha256;
  static constexpr auto fields() {
    return std::tuple_cat(PODM_FIELDS(Work, (cells), (vertices)), WorkRecord::fields(),
                          PODM_FIELDS(Work, (mesh_sha256)));
  }
};

struct Budget {
  GateTrial trial;
  Work work;
  std::uint64_t instructions = 0;  ///< counted by callgrind
};

struct Budgets {
  std::string build;                  ///< compiler and flags of the program whose instructions were counted
  double instructions_tolerance = 0;  ///< relative
  std::vector<Budget> budgets;
  GateTrial timed;  ///< the trial whose seconds are measured
};

/// Throws InputError that names the file and the fault.
Budgets read_budgets(const std::string& path);
void write_budgets(const Budgets& budgets, const std::string& path);

/// Returns the compiler and the flags of this build.
std::string this_build();

Work work_of(const MeshRecord& record);

/// Returns each value that differs from the committed one, e.g. "conflict_tests: 130, committed 120".
std::vector<std::string> differences(const Work& committed, const Work& measured);

}  // namespace podm::bench
