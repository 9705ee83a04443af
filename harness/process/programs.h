// The programs that trials run.
#pragma once

#include <string>

namespace podm::bench {

/// The programs that a trial runs.
struct Programs {
  std::string podm;
  std::string verifier;            ///< empty: meshes are not verified
  std::string peers = {};          ///< folder of other meshers; empty: there are none
  std::string bench = {};          ///< this program, to measure the machine
  std::string likwid_groups = {};  ///< folder of the groups of events for likwid-perfctr
  std::string solver = {};         ///< of finite elements; empty: there is none
};

/// The file of podm-mpi, which is built beside podm where MPI is found.
std::string podm_mpi_of(const std::string& podm);

}  // namespace podm::bench
