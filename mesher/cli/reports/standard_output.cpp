#include "cli/reports/standard_output.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "cli/commands/commands.h"
#include "podm/errors.h"

namespace podm::cli {

void write_standard_output(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw InputError(fmt::format("cannot write standard output: {}", std::generic_category().message(errno)));
}

int run(const ShowText& show) {
  write_standard_output(show.text);
  return 0;
}

}  // namespace podm::cli
