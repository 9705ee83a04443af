// Fuzz target for PVTU indexes of cells and of facets, with three VTU files that they may name. A '|'
// separates the files.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const podm::fuzz::ScratchFolder folder;
  std::string_view rest = podm::fuzz::text_of(data, size);
  for (const char* name : {"a_0.vtu", "a_1.vtu", "a_0_facets.vtu", "a_facets.pvtu"}) {
    const std::size_t end = rest.find('|');
    if (end == rest.npos) return 0;
    folder.write(name, rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  podm::verify::read_checked(folder.write("a.pvtu", rest), size);
  return 0;
}
