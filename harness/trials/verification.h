// Hands a mesh to podm-verify, a separate program, after the clock has stopped.
#pragma once

#include <string>

#include "options/trial_settings.h"
#include "process/process.h"
#include "rows/row.h"

namespace podm::bench {

/// The schedule of leaves and the verifier's report in the folder of a trial.
inline constexpr const char *kScheduleName = "/schedule.jsonl", *kReportName = "/verification.json";

struct Verification {
  ByName<Proof> verdicts;  ///< one per claim; empty if the verifier reports nothing
  std::optional<DihedralRecord> dihedral_deg;
  std::optional<TopologyRecord> topology;
  std::optional<LineDistancesRecord> line_distances;
  std::optional<double> box_ulps_off, interface_distance_mm;
  std::string fault;  ///< the reason why the mesh is not proved; empty: all promised claims pass
  bool is_interrupted = false;
};

/// Returns the verdicts of a report of podm-verify; nothing if it is not a complete report.
std::optional<ByName<Proof>> verdicts_of_report(const Json& report);

/// The time limit of a program that checks the trial's mesh.
double timeout_of_proof_s(const Trial& trial);

/// Asks podm-verify for all claims, four of them under conditions: fidelity if the trial sets it, or if the
/// trial leaves it unset, is of podm and is not in tier kick-tires; dihedral for optimised cells and if it is
/// promised; delaunay for cells that are not optimised; size if the mesh has a bound. `record` is the
/// mesher's, of the mesh at `mesh_path`.
Verification verify_mesh(const Trial& trial, const std::string& image, const MeshRecord& record,
                         const std::string& mesh_path, const std::string& verifier, const std::string& folder,
                         const StopQuery& stop_requested);

inline constexpr const char* kLogName = "/run.log";  ///< the operation log of a trial, in its folder

struct ReplayAttempt {
  Replay replay;
  bool is_interrupted = false;
};

/// Replays the operations of the folder's log one after the other, and compares the mesh with that of the
/// run.
ReplayAttempt replay_mesh(const Trial& trial, const std::string& image, const std::string& podm,
                          const std::string& folder, const StopQuery& stop_requested);

}  // namespace podm::bench
