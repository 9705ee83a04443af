// TetGen files: .node, .ele and .face, apart by a '|'.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = podm::verify::text_of(data, size);
  const std::size_t first = bytes.find('|'),
                    second = first == bytes.npos ? first : bytes.find('|', first + 1);
  if (second == bytes.npos) return 0;
  podm::verify::write_fuzz_file("a.node", bytes.substr(0, first));
  podm::verify::write_fuzz_file("a.ele", bytes.substr(first + 1, second - first - 1));
  podm::verify::write_fuzz_file("a.face", bytes.substr(second + 1));
  podm::verify::read_fuzz_file("a.node", size);
  return 0;
}
