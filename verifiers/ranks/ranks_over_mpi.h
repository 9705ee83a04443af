// Ranks as processes that communicate over MPI.
#pragma once

#include <cstddef>
#include <memory>

#include "ranks/communication.h"

namespace podm::verify {

/// MPI is initialized while it lives.
class MpiSession {
 public:
  MpiSession(int& argc, char**& argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
};

/// Longer messages are sent in pieces of `most_bytes`: MPI counts bytes in 31 bits.
std::unique_ptr<Communication> ranks_over_mpi(std::size_t most_bytes = std::size_t{1} << 30);

/// Returns the number of ranks on this rank's machine.
int ranks_on_this_machine();

/// Ends the processes of all ranks.
[[noreturn]] void abort_all_ranks(int exit_code);

}  // namespace podm::verify
