// Property: any command line either parses or is refused with an InputError that has a text.
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
    else if (data[i] != 0)  // an argument never contains 0
      arguments.back() += static_cast<char>(data[i]);
  }
  arguments.pop_back();  // a last argument without a newline
  try {
    podm::cli::parse_command_line(arguments);
  } catch (const podm::InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
