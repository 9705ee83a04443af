// Hands a mesh to a finite-element solver, a separate program, after the clock has stopped.
#pragma once

#include <string>

#include "options/trial_settings.h"
#include "process/stop_request.h"
#include "rows/row.h"

namespace podm::bench {

struct Solving {
  std::optional<SolveRecord> record;
  std::string fault;  ///< the reason why there is no record
  bool is_interrupted = false;
};

/// Runs the program on the mesh at `mesh_path`: harness/solvers/README.md.
Solving solve_on_mesh(const Trial& trial, const std::string& mesh_path, const std::string& program,
                      const StopQuery& stop_requested);

/// Returns the reason why the program cannot run here; empty: it can.
std::string absence_of_solver(const std::string& program);

}  // namespace podm::bench
