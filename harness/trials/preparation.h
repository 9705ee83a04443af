// What has to be there before a trial's clock starts: its image as a file, and a radius where it asks for a
// number of cells.
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
  std::optional<ResolvedRadius> resolved;  ///< where the trial asks for a number of cells
};

/// The trial's options with radius and delta in place of the number of cells.
Json resolved_options(const Trial& trial, const Preparation& preparation);

/// Makes what is not there yet, once for all trials.
class Preparer {
 public:
  /// Neither reads nor writes anything but what is in the folder of results.
  Preparer(const std::string& podm, const std::string& podm_sha256, const std::string& results_folder);

  /// Returns nothing while something has to be made first.
  std::optional<Preparation> find(const Trial& trial);

  /// Hears what is being made.
  using Announce = std::function<void(const std::string& what)>;
  /// Makes what find() misses. Throws PreparationError. `scratch_folder` must exist.
  Preparation make(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                   const StopQuery& stop_requested);

 private:
  Preparation make_anew(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                        const StopQuery& stop_requested);

  InputFiles inputs_;
  Radii radii_;
  FileHashes hashes_;
  std::map<std::string, PreparationError> failures_;  // what failed once is not tried for each repeat
};

}  // namespace podm::bench
