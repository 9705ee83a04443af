// Finds the circumradius that gives a target number of cells, once per input. All trials with this target
// then do the same work, on any number of cores and with any algorithm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/trial_settings.h"
#include "process/process.h"
#include "rows/row.h"

namespace podm::bench {

struct ImageIdentity {
  std::string name, path, sha256;
  static constexpr auto fields() { return PODM_FIELDS(ImageIdentity, name, path, sha256); }
};

/// A line of radii.jsonl: a radius and its evidence, results/README.md.
struct RadiusLine : ResolvedRadius {
  std::string schema;
  ImageIdentity input;
  std::optional<double> delta_asked_mm;
  JsonPointer calibration, warnings;  ///< as the mesher wrote them
  std::vector<std::string> command;
  ProgramRecord mesher;  ///< without the build
  std::string date;      ///< UTC, in the format of ISO 8601
  static constexpr auto fields() {
    return std::tuple_cat(
        PODM_FIELDS(RadiusLine, schema, input), ResolvedRadius::fields(),
        PODM_FIELDS(RadiusLine, delta_asked_mm, calibration, warnings, command, mesher, date));
  }
};

/// A file of JSON lines, one per radius, with the evidence of each: results/README.md.
class Radii {
 public:
  /// Reads the file, which may be absent. A broken line is skipped.
  Radii(std::string podm, std::string podm_sha256, std::string path);

  /// Returns nothing if there is no radius for the trial's target number of cells (and delta, if given) on an
  /// image of this hash.
  std::optional<ResolvedRadius> find(const Trial& trial, const std::string& image_sha256) const;

  /// Finds a radius by meshing on all usable processors, and stores it. The trial's limits apply. Throws
  /// PreparationError.
  ResolvedRadius resolve(const Trial& trial, const std::string& image, const std::string& image_sha256,
                         const std::string& scratch_folder, const StopQuery& stop_requested);

 private:
  std::string key_of(const Trial& trial, const std::string& image_sha256) const;
  void store(RadiusLine line);

  std::string podm_, podm_sha256_, path_;
  std::vector<RadiusLine> lines_;
};

}  // namespace podm::bench
