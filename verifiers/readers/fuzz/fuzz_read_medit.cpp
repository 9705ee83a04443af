// Medit files: text where the bytes begin so, else binary.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = podm::verify::text_of(data, size);
  const char* name = bytes.starts_with("M") ? "a.mesh" : "a.meshb";
  podm::verify::write_fuzz_file(name, bytes);
  podm::verify::read_fuzz_file(name, size);
  return 0;
}
