// podm-verify: proves or refutes claims about a tetrahedral mesh file.
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "errors.h"
#include "parallel.h"
#include "readers/read_mesh.h"
#include "verify.h"

namespace podm::verify {
namespace {

int main_or_throw(int argc, char** argv) {
  const CommandLine line = parse_command_line(argc, argv, Program::kPodmVerify);
  fmt::print("{}", line.out);
  fmt::print(stderr, "{}", line.err);
  if (!line.command) return line.exit_code;
  Command command = *line.command;
  command.options.threads = num_threads(command.options.threads);
  SingleRank ranks;
  return verify(
      command, ranks, [&] { return read_mesh(command.options.mesh_path); },
      !command.quiet && isatty(STDERR_FILENO) != 0);
}

int report_error(const std::string& fault, int exit_code) {
  fmt::print(stderr, "podm-verify: {}\n", fault);
  return exit_code;
}

}  // namespace
}  // namespace podm::verify

int main(int argc, char** argv) {
  using namespace podm::verify;
  // A file-size limit or a closed pipe then fails the write, which is reported and cleaned up.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return main_or_throw(argc, argv);
  } catch (const InputError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return report_error("out of memory", kInternal);
  } catch (const std::exception& error) {
    return report_error(std::string("internal error: ") + error.what(), kInternal);
  }
}
