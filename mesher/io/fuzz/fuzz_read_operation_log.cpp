// Linearization logs: a file either is one whose operations are in sequence, or is refused with an InputError
// that begins with its path.
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "podm/errors.h"
#include "podm/operation_log.h"

namespace podm {
namespace {

const std::string& file_path() {
  static const std::string path = [] {
    std::string pattern = "/tmp/fuzz_read_operation_log-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    return pattern + "/a.log";
  }();
  return path;
}

void check(bool holds) {
  if (!holds) std::abort();
}

void check(const OperationLog& log) {
  std::size_t num_removed = 0;
  for (std::size_t i = 0; i < log.all.operations.size(); ++i) {
    num_removed += log.all.operations[i].num_removed;
    check(i == 0 || log.all.operations[i - 1].sequence < log.all.operations[i].sequence);
  }
  check(num_removed == log.all.removed.size());
}

}  // namespace
}  // namespace podm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  std::ofstream(file_path(), std::ios::binary) << std::string(reinterpret_cast<const char*>(data), size);
  try {
    check(read_operation_log(file_path()));
  } catch (const InputError& error) {
    check(std::string(error.what()).starts_with(file_path()));
  }
  return 0;
}
