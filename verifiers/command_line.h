// The command line of podm-verify and podm-verify-mpi.
#pragma once

#include <optional>
#include <string>

#include "options.h"

namespace podm::verify {

inline constexpr int kSuccess = 0, kClaimNotMet = 1, kBadInput = 2, kInternal = 3;  ///< exit codes

struct Command {
  Options options;
  bool quiet = false;
  int ranks_in_process = 0;  ///< 0: the ranks are MPI's processes
};

/// A command to carry out, or the texts to show and the exit code instead: help, version, bad usage.
struct CommandLine {
  std::optional<Command> command;
  std::string out, err;
  int exit_code = kSuccess;
};

/// The program that reads the command line has its name and its number of threads by default.
enum class Program { kPodmVerify, kPodmVerifyMpi };

/// Throws InputError.
CommandLine parse_command_line(int argc, const char* const* argv, Program program);

}  // namespace podm::verify
