// podm-verify: proves or refutes claims about a tetrahedral mesh file.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "parallel.h"
#include "readers/read_mesh.h"
#include "report_fault.h"
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

}  // namespace
}  // namespace podm::verify

int main(int argc, char** argv) {
  using namespace podm::verify;
  let_writes_fail();
  try {
    return main_or_throw(argc, argv);
  } catch (...) {
    return report_fault("podm-verify: ");
  }
}
