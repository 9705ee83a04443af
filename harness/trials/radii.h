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

/// The mesher that made a mesh.
struct MesherIdentity {
  std::string sha256, version;
  static constexpr auto fields() {
    return std::tuple{field("sha256", &MesherIdentity::sha256), field("version", &MesherIdentity::version)};
  }
};

struct ImageIdentity {
  std::string name, path, sha256;
  static constexpr auto fields() {
    using I = ImageIdentity;
    return std::tuple{field("name", &I::name), field("path", &I::path), field("sha256", &I::sha256)};
  }
};

/// A line of radii.jsonl: a radius and its evidence, results/README.md.
struct RadiusLine {
  std::string schema, key;
  ImageIdentity input;
  std::uint64_t target_elements = 0;
  std::optional<double> delta_asked_mm;
  double radius_mm = 0, delta_mm = 0;
  std::uint64_t cells = 0;              ///< cells of the mesh that is the evidence
  std::optional<std::uint64_t> meshes;  ///< number of meshes made to find it
  double seconds = 0;                   ///< time spent to find it
  Json calibration, warnings;           ///< as the mesher wrote them
  std::vector<std::string> command;
  MesherIdentity mesher;
  std::string date;  ///< UTC, in the format of ISO 8601
  static constexpr auto fields() {
    using R = RadiusLine;
    return std::tuple{field("schema", &R::schema),
                      field("key", &R::key),
                      field("input", &R::input),
                      field("target_elements", &R::target_elements),
                      field("delta_asked_mm", &R::delta_asked_mm),
                      field("radius_mm", &R::radius_mm),
                      field("delta_mm", &R::delta_mm),
                      field("cells", &R::cells),
                      field("meshes", &R::meshes),
                      field("seconds", &R::seconds),
                      field("calibration", &R::calibration),
                      field("warnings", &R::warnings),
                      field("command", &R::command),
                      field("mesher", &R::mesher),
                      field("date", &R::date)};
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
