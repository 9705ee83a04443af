// A fuzz target that fails on the inputs abort, throw and overflow, and on no other. The test of the driver
// replays them.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

namespace {

// Deep enough to reach the end of any stack. The compiler keeps a volatile object in each frame.
int recurse(int depth) {
  volatile int kept = depth;
  return depth == 0 ? 0 : recurse(depth - 1) + kept;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text == "abort") std::abort();
  if (text == "throw") throw std::runtime_error("thrown");
  if (text == "overflow") return recurse(1 << 30) == 1;
  return 0;
}
