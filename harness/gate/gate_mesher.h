// The mesher as the gate runs it: one process, what it took and what it recorded.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/trial_settings.h"
#include "process/ask.h"
#include "rows/mesher_record.h"

namespace podm::bench {

struct GateTrial {
  std::string name;
  std::string image;  ///< the name that `podm mesh` takes
  double radius_mm = 0;
  static constexpr auto fields() {
    using T = GateTrial;
    return std::tuple{field("name", &T::name), field("image", &T::image), field("radius_mm", &T::radius_mm)};
  }
  bool operator==(const GateTrial&) const = default;
};

struct MesherRun {
  ProcessOutcome process;
  std::optional<MeshRecord> record;  ///< nothing when the mesher wrote none

  double cpu_s() const { return process.user_s + process.system_s; }
};

/// Runs programs in a folder of its own, gone at the end. All throw InputError on a failure to start a
/// program and when the user asks to stop.
class GateMesher {
 public:
  explicit GateMesher(StopQuery stop_requested);
  ~GateMesher();
  GateMesher(const GateMesher&) = delete;
  GateMesher& operator=(const GateMesher&) = delete;

  /// A mesh; `verify` has it proved after, with the verdicts in the record.
  MesherRun mesh(const std::string& podm, const GateTrial& trial, int threads, bool verify) const;

  /// A mesh that is not proved, with its record. Throws InputError also when the mesher fails.
  MesherRun mesh_or_throw(const std::string& podm, const GateTrial& trial, int threads) const;

  /// Instructions of one thread's mesh, counted by callgrind.
  std::uint64_t count_instructions(const std::string& podm, const GateTrial& trial) const;

 private:
  std::vector<std::string> command(const std::string& podm, const GateTrial& trial, int threads) const;
  // Throws where the program did not start and where the user ended it.
  Reply run(const std::vector<std::string>& arguments) const;

  std::string folder_;
  StopQuery stop_requested_;
};

}  // namespace podm::bench
