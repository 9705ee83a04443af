// Ranks as processes, which MPI carries messages between. No other file knows MPI.
#pragma once

#include <memory>

#include "distributed/communication.h"

namespace podm {

/// MPI of this process, from here to the end of its scope: one a process, on the main thread, which alone may
/// call it. A rank that leaves the scope by an exception would wait for the others, so catch it before and
/// call abort_all_ranks().
class MpiSession {
 public:
  /// MPI takes what it knows off the arguments. Throws std::runtime_error if MPI does not start.
  MpiSession(int& argc, char**& argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
};

/// MPI's own counts end at 2^31 - 1: what is longer goes in pieces.
constexpr std::size_t kMostBytesOfMpiCall = std::size_t{1} << 30;

/// All processes of the run, whose messages meet no others of theirs. The session must outlive it. Its
/// functions throw std::runtime_error with MPI's own text when a call fails. No call hands MPI more than
/// `most_bytes`, at least 8.
std::unique_ptr<Communication> mpi_communication(std::size_t most_bytes = kMostBytesOfMpiCall);

/// Ends all processes of the run, with this exit code: what a rank calls that cannot go on.
[[noreturn]] void abort_all_ranks(int exit_code);

}  // namespace podm
