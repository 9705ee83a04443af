// Fuzz target for Medit files: text if the bytes begin as text does, otherwise binary.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const podm::fuzz::ScratchFolder folder;
  const std::string_view bytes = podm::fuzz::text_of(data, size);
  const char* name = bytes.starts_with("M") ? "a.mesh" : "a.meshb";
  podm::verify::read_checked(folder.write(name, bytes), size);
  return 0;
}
