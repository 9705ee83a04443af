// podm-verify-mpi: podm-verify on ranks, each of which reads some pieces of a mesh. Exit codes as
// podm-verify. The first rank reports faults that all ranks know, and all ranks end. Otherwise the rank that
// fails reports its fault and ends the other ranks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "parallel.h"
#include "ranks/ranks_in_process.h"
#include "ranks/ranks_over_mpi.h"
#include "readers/read_pvtu_part.h"
#include "verify.h"

namespace podm::verify {
namespace {

int complain(const std::string& fault, int exit_code) {
  fmt::print(stderr, "podm-verify-mpi: {}\n", fault);
  return exit_code;
}

// Reports a fault that only some ranks know.
int complain_of_one(const Communication& ranks) {
  const std::string who =
      ranks.size() > 1 ? fmt::format("rank {} of {}: ", ranks.rank(), ranks.size()) : std::string();
  try {
    throw;
  } catch (const InputError& error) {
    return complain(who + error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain(who + "out of memory", kInternal);
  } catch (const std::exception& error) {
    return complain(who + "internal error: " + error.what(), kInternal);
  }
}

int verify_part(Command command, Communication& ranks, int ranks_on_machine) {
  command.options.threads = num_threads(command.options.threads, ranks_on_machine);
  const std::string& path = command.options.mesh_path;
  do_on_all(ranks, [&] {
    if (!path.ends_with(".pvtu") && !path.ends_with(".pvtu.gz"))
      throw InputError(path + ": not a mesh in pieces (.pvtu); podm-verify reads the other formats");
  });
  return verify(
      command, ranks, [&] { return read_pvtu_part(path, ranks); }, false);
}

int verify_in_process(const Command& command) {
  int exit_code = kSuccess;
  run_ranks(command.ranks_in_process, [&](Communication& ranks) {
    const int of_rank = verify_part(command, ranks, ranks.size());
    if (ranks.rank() == 0) exit_code = of_rank;
  });
  return exit_code;
}

int run(int argc, char** argv, Communication& ranks) {
  expect_agreement(ranks, {{"command line", fmt::format("{}", fmt::join(argv + 1, argv + argc, " "))}});
  CommandLine line;
  do_on_all(ranks, [&] {
    line = parse_command_line(argc, argv, Program::kPodmVerifyMpi);
    if (line.command && line.command->ranks_in_process > 0 && ranks.size() > 1)
      throw InputError(
          fmt::format("--in-process: MPI has started {} processes; ranks in process need one", ranks.size()));
  });
  if (ranks.rank() == 0) {
    fmt::print("{}", line.out);
    fmt::print(stderr, "{}", line.err);
  }
  if (!line.command) return line.exit_code;
  if (line.command->ranks_in_process > 0) return verify_in_process(*line.command);
  return verify_part(*line.command, ranks, ranks_on_this_machine());
}

}  // namespace
}  // namespace podm::verify

int main(int argc, char** argv) {
  using namespace podm::verify;
  // A file-size limit or a closed pipe then fails the write, which is reported and cleaned up.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const MpiSession session(argc, argv);
    const auto ranks = ranks_over_mpi();
    try {
      return run(argc, argv, *ranks);
    } catch (const RefusedByAll& error) {
      return ranks->rank() == 0 ? complain(error.what(), kBadInput) : kBadInput;
    } catch (...) {
      const int exit_code = complain_of_one(*ranks);
      if (ranks->size() == 1) return exit_code;
      abort_all_ranks(exit_code);
    }
  } catch (const std::exception& error) {
    return complain(error.what(), kInternal);
  }
}
