// Fuzz target for Gmsh files.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const podm::fuzz::ScratchFolder folder;
  podm::verify::read_checked(folder.write("a.msh", podm::fuzz::text_of(data, size)), size);
  return 0;
}
