// podm-verify-mpi: podm-verify on ranks, each of which reads some pieces of a mesh. Exit codes as
// podm-verify. The first rank reports faults that all ranks know, and all ranks end. Otherwise the rank that
// fails reports its fault and ends the other ranks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "parallel.h"
#include "ranks/ranks_in_process.h"
#include "ranks/ranks_over_mpi.h"
#include "readers/read_pvtu_part.h"
#include "report_fault.h"
#include "verify.h"

namespace podm::verify {
namespace {

// Reports a fault that only some ranks know. Returns the exit code.
int report_fault_of_one(const Communication& ranks) {
  return report_fault(ranks.size() > 1
                          ? fmt::format("podm-verify-mpi: rank {} of {}: ", ranks.rank(), ranks.size())
                          : "podm-verify-mpi: ");
}

int verify_part(Command command, Communication& ranks, int ranks_on_machine) {
  command.options.threads = num_threads(command.options.threads, ranks_on_machine);
  const std::string& path = command.options.mesh_path;
  do_on_all(ranks, [&] {
    const auto& claims = command.options.claims;
    for (const char* claim : {"lines", "topology"})
      if (std::find(claims.begin(), claims.end(), claim) != claims.end())
        throw InputError(fmt::format(
            "--claims {}: not on ranks, as it needs the whole mesh; podm-verify checks it", claim));
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
  let_writes_fail();
  try {
    const MpiSession session(argc, argv);
    const auto ranks = ranks_over_mpi();
    try {
      return run(argc, argv, *ranks);
    } catch (const RefusedByAll&) {
      return ranks->rank() == 0 ? report_fault("podm-verify-mpi: ") : kBadInput;
    } catch (...) {
      const int exit_code = report_fault_of_one(*ranks);
      if (ranks->size() == 1) return exit_code;
      abort_all_ranks(exit_code);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "podm-verify-mpi: {}\n", error.what());
    return kInternal;
  }
}
