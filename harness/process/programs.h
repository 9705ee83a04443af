#pragma once

#include <string>

namespace podm::bench {

/// The programs that trials run.
struct Programs {
  std::string podm;
  std::string verifier;            ///< empty: meshes are not verified
  std::string peers = {};          ///< folder of the peers; empty: there are none
  std::string bench = {};          ///< podm-bench, which measures the machine
  std::string likwid_groups = {};  ///< folder of the event groups of likwid-perfctr
  std::string solver = {};         ///< finite-element solver; empty: there is none
};

/// Returns the path of podm-mpi, which is built beside podm where MPI is found.
std::string podm_mpi_of(const std::string& podm);

}  // namespace podm::bench
