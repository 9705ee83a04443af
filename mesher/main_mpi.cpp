// The podm-mpi program: podm mesh and podm replay on ranks. Exit codes as podm: 0 success, 1 a guarantee or
// limit is unmet, 2 bad usage or input, 3 internal error. Rank 0 reports faults that all ranks know, and all
// ranks end. Otherwise the rank that fails reports its fault and ends the other ranks.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "cli/commands/commands.h"
#include "cli/commands/mesh_on_ranks.h"
#include "distributed/collective_errors.h"
#include "distributed/mpi_communication.h"
#include "distributed/rank_failure.h"

namespace {

constexpr int kBadInput = 2, kInternal = 3;

// Reports a failure that names its rank. Returns the exit code.
int complain(const std::exception_ptr& failure) try {
  std::rethrow_exception(failure);
} catch (const podm::InputError& error) {
  fmt::print(stderr, "podm-mpi: {}\n", error.what());
  return kBadInput;
} catch (const std::bad_alloc& error) {
  fmt::print(stderr, "podm-mpi: {}; use more machines, a larger radius or --max-memory-gib\n", error.what());
  return kInternal;
} catch (const std::exception& error) {
  fmt::print(stderr, "podm-mpi: internal error: {}\n", error.what());
  return kInternal;
}

int ranks_in_process(const podm::cli::Command& command) {
  if (const auto* mesh = std::get_if<podm::cli::MeshCommand>(&command)) return mesh->ranks_in_process;
  if (const auto* replay = std::get_if<podm::cli::ReplayCommand>(&command)) return replay->ranks_in_process;
  return 0;
}

int run_in_process(const podm::cli::Command& command, podm::cli::SignalThread& signals) try {
  if (const auto* replay = std::get_if<podm::cli::ReplayCommand>(&command))
    return podm::cli::replay_in_process(*replay);
  return podm::cli::mesh_in_process(std::get<podm::cli::MeshCommand>(command), signals);
} catch (const podm::RefusedByAll&) {
  throw;
} catch (...) {
  return complain(std::current_exception());
}

podm::cli::Command parse(int argc, char** argv, const podm::Communication& ranks) {
  auto command = podm::cli::parse_command_line({argv + 1, argv + argc}, podm::cli::Program::kPodmMpi);
  if (ranks_in_process(command) > 0 && ranks.size() > 1)
    throw podm::InputError(
        fmt::format("--in-process: MPI has started {} processes; ranks in process need one", ranks.size()));
  return command;
}

int run(int argc, char** argv, podm::Communication& ranks, podm::cli::SignalThread& signals) {
  namespace cli = podm::cli;
  cli::Command command;
  podm::do_collectively([&] { command = parse(argc, argv, ranks); }, ranks);
  const auto* const text = std::get_if<cli::ShowText>(&command);
  const auto* const replay = std::get_if<cli::ReplayCommand>(&command);
  const char* const name = text != nullptr ? "a text to show" : replay != nullptr ? "replay" : "mesh";
  podm::expect_agreement({{"command", name}}, ranks);
  if (text != nullptr) return ranks.rank() == 0 ? cli::run(*text) : 0;
  if (ranks_in_process(command) > 0) return run_in_process(command, signals);
  cli::SharedByRanks shared;
  if (replay != nullptr) return cli::replay_on_ranks(*replay, ranks, shared);
  return cli::mesh_on_ranks(std::get<cli::MeshCommand>(command), ranks, signals, shared);
}

// Ends all ranks by the exception that is being handled. A rank without memory to report it terminates, which
// also ends them: a rank that left its communication would wait for the others.
[[noreturn]] void end_all_ranks(const podm::Communication& ranks) noexcept {
  const podm::RankFailure failure = podm::current_rank_failure(ranks.rank(), ranks.size());
  podm::abort_all_ranks(complain(failure.exception));
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
