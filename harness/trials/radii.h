// The circumradius that gives a number of cells, found once for an input, so that all trials that ask for
// this number do the same work, on any number of cores and with any algorithm.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "trials/process.h"

namespace podm::bench {

/// A file of JSON lines, one a radius with what it was found from: results/README.md.
class Radii {
 public:
  /// Reads what the file holds; there need be none. A broken line is passed over.
  Radii(std::string podm, std::string podm_sha256, std::string path);

  /// What rows tell of the radius: number of cells asked for, `radius_mm`, `delta_mm`, `cells` of the mesh
  /// that is the evidence, `meshes` that finding it took, `seconds` that it cost, `key`. Null while there is
  /// none for the trial's number of cells, and delta where it gives one, on an image of this hash.
  nlohmann::ordered_json find(const Trial& trial, const std::string& image_sha256) const;

  /// Finds it by a mesh on all usable processors and stores it. The trial's limits hold. Throws
  /// PreparationError.
  nlohmann::ordered_json resolve(const Trial& trial, const std::string& image,
                                 const std::string& image_sha256, const std::string& scratch_folder,
                                 const StopQuery& stop_requested);

 private:
  std::string key_of(const Trial& trial, const std::string& image_sha256) const;
  void store(nlohmann::ordered_json line);

  std::string podm_, podm_sha256_, path_;
  std::vector<nlohmann::ordered_json> lines_;
};

}  // namespace podm::bench
