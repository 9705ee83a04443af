// Ranks as processes that communicate over MPI. No other file uses MPI.
#pragma once

#include <memory>

#include "distributed/communication.h"

namespace podm {

/// MPI of this process, until the end of the scope. There is one session per process, on the main thread,
/// which is the only thread that may call MPI. A rank that leaves the scope by an exception would wait for
/// the other ranks. The caller must therefore catch the exception before and call abort_all_ranks().
class MpiSession {
 public:
  /// Removes MPI's own arguments. Throws std::runtime_error if MPI does not start.
  MpiSession(int& argc, char**& argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
};

/// MPI's counts end at 2^31 - 1, so longer messages are sent in pieces.
constexpr std::size_t kMostBytesOfMpiCall = std::size_t{1} << 30;

/// Returns the communication of all processes of the run. Collective, as is its destructor. Its messages do
/// not mix with other messages of the processes. The session must outlive it. Its functions throw
/// std::runtime_error with MPI's own text when a call fails. No call passes more than `most_bytes`, at least
/// 8, to MPI.
std::unique_ptr<Communication> mpi_communication(std::size_t most_bytes = kMostBytesOfMpiCall);

/// Ends all processes of the run with this exit code. A rank that cannot continue calls it.
[[noreturn]] void abort_all_ranks(int exit_code);

}  // namespace podm
