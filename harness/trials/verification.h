// A mesh handed to podm-verify, a program of its own, after the clock has stopped.
#pragma once

#include <string>

#include "options/trial_settings.h"
#include "process/process.h"
#include "rows/row.h"

namespace podm::bench {

inline constexpr const char* kScheduleName = "/schedule.jsonl";  ///< its file in the folder of a trial

struct Verification {
  ByName<Proof> verdicts;  ///< one a claim; empty when the verifier told nothing
  std::optional<DihedralRecord> dihedral_deg;
  std::optional<TopologyRecord> topology;
  std::string fault;  ///< why the mesh is not proved; empty: every claim promised passes
  bool is_interrupted = false;
};

/// How long a program may take that looks at the trial's mesh.
double timeout_of_proof_s(const Trial& trial);

/// Every claim; fidelity where the trial asks for it, or says nothing of it and is podm's, of another tier
/// than kick-tires; dihedral of optimised cells and where it is promised, delaunay of cells that are not
/// optimised. `record` is the mesher's, of the mesh at `mesh_path`.
Verification verify_mesh(const Trial& trial, const std::string& image, const MeshRecord& record,
                         const std::string& mesh_path, const std::string& verifier, const std::string& folder,
                         const StopQuery& stop_requested);

inline constexpr const char* kLogName = "/run.log";  ///< the log of a trial's operations, in its folder

struct ReplayAttempt {
  Replay replay;
  bool is_interrupted = false;
};

/// Whether the operations in the folder's log, one after the other, make the mesh that the run made.
ReplayAttempt replay_mesh(const Trial& trial, const std::string& image, const std::string& podm,
                          const std::string& folder, const StopQuery& stop_requested);

}  // namespace podm::bench
