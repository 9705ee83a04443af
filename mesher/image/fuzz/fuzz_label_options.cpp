// Any text is taken as label ranges, a merge or a label table, or is refused with an InputError that says
// something; what is taken is well formed.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "podm/errors.h"
#include "podm/image_io.h"

namespace {

template <class Parse>
void parses_or_refuses(Parse parse) {
  try {
    parse();
  } catch (const podm::InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

// Written anew for each input.
std::string table_path() {
  std::string name = "/tmp/fuzz_label_options-XXXXXX";
  const int file = mkstemp(name.data());
  if (file < 0) std::abort();
  close(file);
  return name;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  parses_or_refuses([&] {
    for (const auto& [first, last] : podm::parse_label_ranges(text, "--labels"))
      if (first > last) std::abort();
  });
  parses_or_refuses([&] {
    const auto merge = podm::parse_merge(text);
    if (merge.values.empty() || merge.name.empty()) std::abort();
  });
  static const std::string path = table_path();
  std::ofstream(path, std::ios::binary) << text;
  parses_or_refuses([&] {
    if (podm::read_label_names(path).empty()) std::abort();
  });
  return 0;
}
