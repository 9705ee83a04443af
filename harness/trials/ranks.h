// Trials of podm-mpi: the mesher on ranks, which are processes over MPI or threads of one process.
#pragma once

#include <string>
#include <vector>

#include "options/trial_settings.h"
#include "process/process.h"

namespace podm::bench {

/// Returns the number of ranks of the trial; 0: podm makes the mesh.
int num_ranks(const Trial& trial);
/// True if ranks are processes. Otherwise they are threads of one process that compute one after the other,
/// in virtual time.
bool is_over_mpi(const nlohmann::ordered_json& options);

/// Returns the reason why the ranks of the trial cannot run here; empty: they can, or there are none.
std::string absence_of_ranks(const Trial& trial, const std::string& podm);

/// Returns the program that makes the trial's mesh, with its launcher for ranks, up to its command `mesh`.
std::vector<std::string> mesher_of(const Trial& trial, const std::string& podm);

/// Returns the bytes of all pieces of a mesh with this index; 0 if there is no index.
std::uint64_t bytes_of_pieces(const std::string& index_path);

}  // namespace podm::bench
