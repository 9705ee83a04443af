// Any text is either accepted as label ranges, layers, a merge or a label table, or refused with an
// InputError that has a message. Accepted input is well formed.
#include <string>

#include "fuzz_scratch.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace {

using podm::fuzz::check;

template <class Parse>
void parses_or_refuses(Parse parse) {
  try {
    parse();
  } catch (const podm::InputError& error) {
    check(error.what()[0] != '\0');
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const podm::fuzz::ScratchFolder folder;
  const std::string text(podm::fuzz::text_of(data, size));
  parses_or_refuses([&] {
    for (const auto& [first, last] : podm::parse_label_ranges(text, "--labels")) check(first <= last);
  });
  parses_or_refuses([&] { check(!podm::parse_layers(text, "--layers").empty()); });
  parses_or_refuses([&] {
    const auto merge = podm::parse_merge(text);
    check(!merge.values.empty() && !merge.name.empty());
  });
  parses_or_refuses([&] { check(!podm::read_label_table(folder.write("table.txt", text)).empty()); });
  return 0;
}
