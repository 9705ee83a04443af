// Makes some meshes of a submission again, on this machine and with the programs of the judge.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "process/programs.h"
#include "process/stop_request.h"
#include "submissions/checks.h"

namespace podm::bench {

struct RemeshSettings {
  Programs programs;
  std::size_t num_meshes = 3;  ///< meshes to make, of rows drawn by the seed
  std::uint64_t seed = 0;
  std::map<std::string, std::string> images;  ///< files of this machine by their hash
};

struct Remeshing {
  std::vector<std::string> made;      ///< one line per mesh that was made and compared
  std::vector<std::string> not_made;  ///< rows that were drawn, and why they cannot be made here
};

/// Draws rows and makes their meshes again: phantoms are drawn, images are found by their hash. The new mesh
/// must pass the claims that the row's mesh passed, and equal the replay of its own operations. It must have
/// the hash of the row's mesh if one thread or virtual time made it, otherwise about as many cells. A row of
/// a stranger's trial is made only if its options name no file. Adds a fault for each difference.
Remeshing remesh_sample(const Submission& submission, const ExperimentsOn& experiments,
                        const RemeshSettings& settings, const StopQuery& stop_requested, Faults& faults);

}  // namespace podm::bench
