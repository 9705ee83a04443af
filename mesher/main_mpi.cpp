// The podm-mpi program: what podm mesh does, on ranks. 0 success, 1 a guarantee or limit is unmet, 2 bad
// usage or input, 3 internal error, as podm. What all ranks know of is told by rank 0, and all leave; else
// the rank that fails says so and ends the others.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>

#include "cli/commands.h"
#include "cli/mesh_on_ranks.h"
#include "distributed/mpi_communication.h"
#include "distributed/rank_failure.h"
#include "distributed/together.h"

namespace {

constexpr int kBadInput = 2, kInternal = 3;

int run(int argc, char** argv, podm::Communication& ranks, podm::cli::SignalThread& signals) {
  namespace cli = podm::cli;
  std::optional<cli::Command> command;
  const auto parse = [&] {
    command = cli::parse_command_line({argv + 1, argv + argc}, cli::Program::kPodmMpi);
  };
  podm::do_together(parse, ranks);
  if (const auto* mesh = std::get_if<cli::MeshCommand>(&*command))
    return cli::mesh_on_ranks(*mesh, ranks, signals);
  return ranks.rank() == 0 ? cli::run(std::get<cli::ShowText>(*command)) : 0;
}

// The exception being handled is this rank's alone.
[[noreturn]] void end_all_ranks(const podm::Communication& ranks) {
  int code = kInternal;
  try {
    std::rethrow_exception(podm::current_rank_failure(ranks.rank(), ranks.size()).exception);
  } catch (const podm::InputError& error) {
    fmt::print(stderr, "podm-mpi: {}\n", error.what());
    code = kBadInput;
  } catch (const std::bad_alloc& error) {
    fmt::print(stderr, "podm-mpi: {}; use more machines, a larger radius or --max-memory-gib\n",
               error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "podm-mpi: internal error: {}\n", error.what());
  }
  podm::abort_all_ranks(code);
}

}  // namespace

int main(int argc, char** argv) try {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  podm::cli::SignalThread signals;  // before the threads of MPI
  const podm::MpiSession session(argc, argv);
  const auto ranks = podm::mpi_communication();
  try {
    return run(argc, argv, *ranks, signals);
  } catch (const podm::RefusedByAll& error) {
    if (ranks->rank() == 0) fmt::print(stderr, "podm-mpi: {}\n", error.what());
    return kBadInput;
  } catch (...) {
    end_all_ranks(*ranks);
  }
} catch (const std::exception& error) {
  fmt::print(stderr, "podm-mpi: {}\n", error.what());
  return kInternal;
}
