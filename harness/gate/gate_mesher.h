// Runs the mesher for the gate: one process, its time and its record.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "process/ask.h"
#include "rows/mesher_record.h"

namespace podm::bench {

struct GateTrial {
  std::string name;
  std::string image;  ///< the name that `podm mesh` takes
  double radius_mm = 0;
  static constexpr auto fields() { return PODM_FIELDS(GateTrial, name, image, radius_mm); }
  bool operator==(const GateTrial&) const = default;
};

struct MesherRun {
  ProcessOutcome process;
  std::optional<MeshRecord> record;  ///< unset if the mesher wrote none

  double cpu_s() const { return process.user_s + process.system_s; }
};

/// Runs programs in a temporary folder of its own. All functions throw InputError when a program does not
/// start and when the user asks to stop.
class GateMesher {
 public:
  explicit GateMesher(StopQuery stop_requested);
  ~GateMesher();
  GateMesher(const GateMesher&) = delete;
  GateMesher& operator=(const GateMesher&) = delete;

  /// Makes a mesh. With `verify`, the mesh is proved afterwards and the record has the verdicts.
  MesherRun mesh(const std::string& podm, const GateTrial& trial, int threads, bool verify) const;

  /// Makes a mesh without a proof, with its record. Throws InputError also when the mesher fails.
  MesherRun mesh_or_throw(const std::string& podm, const GateTrial& trial, int threads) const;

  /// Returns the instructions of one thread's mesh, counted by callgrind.
  std::uint64_t count_instructions(const std::string& podm, const GateTrial& trial) const;

 private:
  std::vector<std::string> command(const std::string& podm, const GateTrial& trial, int threads) const;
  // Throws if the program did not start or the user ended it.
  Reply run(const std::vector<std::string>& arguments) const;

  std::string folder_;
  StopQuery stop_requested_;
};

}  // namespace podm::bench
