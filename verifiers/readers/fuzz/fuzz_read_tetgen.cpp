// Fuzz target for TetGen's .node, .ele and .face. A '|' separates the files.
#include "readers/fuzz/checked_read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const podm::fuzz::ScratchFolder folder;
  const std::string_view bytes = podm::fuzz::text_of(data, size);
  const std::size_t first = bytes.find('|'),
                    second = first == bytes.npos ? first : bytes.find('|', first + 1);
  if (second == bytes.npos) return 0;
  folder.write("a.ele", bytes.substr(first + 1, second - first - 1));
  folder.write("a.face", bytes.substr(second + 1));
  podm::verify::read_checked(folder.write("a.node", bytes.substr(0, first)), size);
  return 0;
}
