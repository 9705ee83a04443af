// The podm program. Exit codes: 0 success, 1 a guarantee or limit is unmet, 2 bad usage or input, 3 internal
// error. A signal before there is a mesh ends the program by that signal.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "cli/commands/commands.h"
#include "podm/errors.h"

namespace {

constexpr int kBadInput = 2, kInternal = 3;

int complain(const std::string& fault, int exit_code) {
  fmt::print(stderr, "podm: {}\n", fault);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  // A file-size limit and a closed pipe then fail the write, which is reported and cleaned up.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const podm::cli::Command command = podm::cli::parse_command_line({argv + 1, argv + argc});
    return std::visit([](const auto& chosen) { return podm::cli::run(chosen); }, command);
  } catch (const podm::InputError& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain("out of memory; use a smaller image, a larger radius or --max-memory-gib", kInternal);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kInternal);
  }
}
