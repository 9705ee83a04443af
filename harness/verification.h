// A mesh handed to podm-verify, a program of its own, after the clock has stopped.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "experiment.h"
#include "process.h"

namespace podm::bench {

inline constexpr const char* kScheduleName = "/schedule.jsonl";  ///< in the folder of a trial

/// The programs that a trial runs.
struct Programs {
  std::string podm;
  std::string verifier;            ///< empty: meshes are not verified
  std::string peers = {};          ///< folder of other meshers; empty: there are none
  std::string bench = {};          ///< this program, to measure the machine
  std::string likwid_groups = {};  ///< folder of the groups of events for likwid-perfctr
};

struct Verification {
  nlohmann::ordered_json
      verdicts;       ///< claim: "pass", "fail" or "not_run"; empty when the verifier told nothing
  std::string fault;  ///< why the mesh is not proved; empty: every claim promised passes
  bool is_interrupted = false;
};

/// The file of an image, a phantom's written to `folder` unless it is there. Empty: it could not be.
std::string image_file(const Trial& trial, const nlohmann::ordered_json& image_size, const std::string& podm,
                       const std::string& folder);

/// Every claim but fidelity, which is promised only for cells about as small as voxels. `record` is the
/// mesher's, of the mesh at `mesh_path`. A phantom, whose voxels per axis are `image_size`, is written to
/// `folder` first.
Verification verify_mesh(const Trial& trial, const nlohmann::ordered_json& image_size,
                         const nlohmann::ordered_json& record, const std::string& mesh_path,
                         const Programs& programs, const std::string& folder,
                         const StopQuery& stop_requested);

}  // namespace podm::bench
