#include "process/programs.h"

#include <filesystem>

namespace podm::bench {

std::string podm_mpi_of(const std::string& podm) {
  return (std::filesystem::path(podm).parent_path() / "podm-mpi").string();
}

}  // namespace podm::bench
