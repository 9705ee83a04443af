// Makes the inputs of a trial before its clock starts: its image as a file, and a radius if the trial gives a
// target number of cells.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "options/trial_settings.h"
#include "process/process.h"
#include "process/sha256.h"
#include "trials/input_files.h"
#include "trials/radii.h"

namespace podm::bench {

struct Preparation {
  std::string image;                       ///< the file that is read
  std::string sha256;                      ///< hash of its bytes; "absent" where there is no file
  std::optional<ResolvedRadius> resolved;  ///< if the trial gives a target number of cells
  std::optional<double> voxel_mm = {};     ///< edge of the cube of a voxel's volume, if the trial needs it
};

/// The options with radius and delta, if they were found, in place of the target number of cells.
Json with_radius(Json options, const std::optional<ResolvedRadius>& resolved);

/// The trial's options as the mesher takes them: with_radius(), and lengths in voxels in millimetres.
Json resolved_options(const Trial& trial, const Preparation& preparation);

/// Makes missing inputs, once for all trials.
class Preparer {
 public:
  /// Keeps phantoms and radii in the folder of results.
  Preparer(const std::string& podm, const std::string& podm_sha256, const std::string& results_folder);

  /// Returns nothing if an input must be made first.
  std::optional<Preparation> find(const Trial& trial);

  /// Receives the name of each input that is being made.
  using Announce = std::function<void(const std::string& what)>;
  /// Makes the inputs that find() misses. Throws PreparationError. `scratch_folder` must exist.
  Preparation make(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                   const StopQuery& stop_requested);

 private:
  Preparation make_anew(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                        const StopQuery& stop_requested);

  void measure_voxel(const std::string& path, const StopQuery& stop_requested);

  std::string podm_;
  InputFiles inputs_;
  Radii radii_;
  FileHashes hashes_;
  std::map<std::string, double> voxels_mm_;           // each image is read once
  std::map<std::string, PreparationError> failures_;  // a failed input is not retried in each repeat
};

}  // namespace podm::bench
