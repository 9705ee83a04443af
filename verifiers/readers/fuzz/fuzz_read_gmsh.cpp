// Gmsh files.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = podm::verify::text_of(data, size);
  podm::verify::write_fuzz_file("a.msh", bytes);
  podm::verify::read_fuzz_file("a.msh", size);
  return 0;
}
