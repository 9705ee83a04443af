// Property: a file either is a linearization log whose operations are in sequence, or is refused with an
// InputError that begins with its path.
#include "fuzz_scratch.h"
#include "podm/errors.h"
#include "podm/operation_log.h"

namespace podm {
namespace {

using fuzz::check;

void check_log(const OperationLog& log) {
  std::size_t num_removed = 0;
  for (std::size_t i = 0; i < log.all.operations.size(); ++i) {
    num_removed += log.all.operations[i].num_removed;
    check(i == 0 || log.all.operations[i - 1].sequence < log.all.operations[i].sequence);
  }
  check(num_removed == log.all.removed.size());
  check(log.head.rank >= 0 && log.head.rank < log.head.num_ranks);
}

}  // namespace
}  // namespace podm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  static const fuzz::ScratchFolder folder;
  const std::string path = folder.write("a.log", fuzz::text_of(data, size));
  try {
    check_log(read_operation_log(path));
  } catch (const InputError& error) {
    check(std::string_view(error.what()).starts_with(path));
  }
  return 0;
}
