// Any command line either parses or is refused with an InputError that says something.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "cli/options/options.h"
#include "podm/errors.h"

// The bytes are the arguments, each ended by a newline.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> arguments(1);
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] == '\n')
      arguments.emplace_back();
    else if (data[i] != 0)  // never part of an argument
      arguments.back() += static_cast<char>(data[i]);
  }
  arguments.pop_back();  // what no newline ended
  try {
    podm::cli::parse_command_line(arguments);
  } catch (const podm::InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
