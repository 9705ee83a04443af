#include "trials/ranks.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "options/option_keys.h"
#include "process/programs.h"

namespace podm::bench {

namespace fs = std::filesystem;

int num_ranks(const Trial& trial) { return trial.options.value(kRanks, 0); }

bool is_over_mpi(const nlohmann::ordered_json& options) { return options.value(kCarrier, "") == kMpi; }

std::string absence_of_ranks(const Trial& trial, const std::string& podm) {
  if (num_ranks(trial) == 0) return "";
  const std::string program = podm_mpi_of(podm);
  if (access(program.c_str(), X_OK) != 0)
    return fmt::format("{} does not exist: it is built if MPI is found, which scripts/setup installs",
                       program);
  return is_over_mpi(trial.options) && !is_installed("mpirun") ? "mpirun is not installed" : "";
}

// More ranks than processors are allowed; ranks that wait yield the processor. The variables are Open MPI's,
// which otherwise refuses to run as root.
std::vector<std::string> mesher_of(const Trial& trial, const std::string& podm) {
  const std::string ranks = std::to_string(num_ranks(trial));
  if (num_ranks(trial) == 0) return {podm, "mesh"};
  if (!is_over_mpi(trial.options)) return {podm_mpi_of(podm), "mesh", "--in-process", ranks};
  return {"env",
          "OMPI_ALLOW_RUN_AS_ROOT=1",
          "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
          "OMPI_MCA_mpi_yield_when_idle=1",
          "mpirun",
          "--oversubscribe",
          "-n",
          ranks,
          podm_mpi_of(podm),
          "mesh"};
}

std::uint64_t bytes_of_pieces(const std::string& index_path) {
  if (!fs::exists(index_path)) return 0;
  const fs::path index(index_path);
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(index.parent_path()))
    if (entry.path().filename().string().starts_with(index.stem().string())) bytes += entry.file_size();
  return bytes;
}

}  // namespace podm::bench
