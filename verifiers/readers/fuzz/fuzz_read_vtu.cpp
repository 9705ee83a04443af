// VTU files, gzipped where the bytes begin so.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = podm::verify::text_of(data, size);
  const char* name = bytes.starts_with("\x1f\x8b") ? "a.vtu.gz" : "a.vtu";
  podm::verify::write_fuzz_file(name, bytes);
  podm::verify::read_fuzz_file(name, size);
  return 0;
}
