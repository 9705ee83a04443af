// Schedules of runs: a file either is one that keeps what Schedule promises, or is refused with an InputError
// that begins with its path.
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "errors.h"
#include "schedule.h"

namespace podm::verify {
namespace {

const std::string& file_path() {
  static const std::string path = [] {
    std::string pattern = "/tmp/fuzz_read_schedule-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    return pattern + "/a.jsonl";
  }();
  return path;
}

void check(bool holds) {
  if (!holds) std::abort();
}

void check(const Schedule& schedule) {
  for (const double x : schedule.mesh_to_grid) check(std::isfinite(x));
  for (const Leaf& leaf : schedule.leaves) {
    check(std::has_single_bit(static_cast<std::uint64_t>(leaf.side)));
    for (const std::int64_t x : leaf.corner) check(std::fabs(static_cast<double>(x)) <= 0x1p40);
  }
  for (const Activation& a : schedule.activations) {
    check(a.leaf < schedule.leaves.size() && a.begin_s <= a.end_s);
    for (const std::uint32_t touched : a.touched_leaves) check(touched < schedule.leaves.size());
  }
}

}  // namespace
}  // namespace podm::verify

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm::verify;
  std::ofstream(file_path(), std::ios::binary) << std::string(reinterpret_cast<const char*>(data), size);
  try {
    check(read_schedule(file_path()));
  } catch (const InputError& error) {
    check(std::string(error.what()).starts_with(file_path()));
  }
  return 0;
}
