// Trials that podm-mpi runs: the mesher on ranks, which are processes over MPI or threads of one process.
#pragma once

#include <string>
#include <vector>

#include "options/trial_settings.h"
#include "process/process.h"

namespace podm::bench {

/// Ranks that the trial asks for; 0: podm makes the mesh.
int num_ranks(const Trial& trial);
/// Whether they are processes; threads of one process compute one after the other, in virtual time.
bool is_over_mpi(const nlohmann::ordered_json& options);

/// Why the ranks of the trial cannot run here; empty: they can, or there are none.
std::string absence_of_ranks(const Trial& trial, const std::string& podm);

/// The program that makes the trial's mesh, with what makes it run on ranks, up to its command `mesh`.
std::vector<std::string> mesher_of(const Trial& trial, const std::string& podm);

/// Bytes of all pieces of a mesh with this index; 0 without it.
std::uint64_t bytes_of_pieces(const std::string& index_path);

}  // namespace podm::bench
