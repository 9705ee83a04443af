// Fuzz target for schedules of runs: a file is a schedule that keeps the guarantees of Schedule, or it is
// refused with an InputError that begins with its path.
#include <bit>
#include <cmath>

#include "errors.h"
#include "fuzz_scratch.h"
#include "schedule.h"

namespace podm::verify {
namespace {

using fuzz::check;

void check_schedule(const Schedule& schedule) {
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
  using namespace podm;
  static const fuzz::ScratchFolder folder;
  const std::string path = folder.write("a.jsonl", fuzz::text_of(data, size));
  try {
    verify::check_schedule(verify::read_schedule(path));
  } catch (const verify::InputError& error) {
    verify::check(std::string_view(error.what()).starts_with(path));
  }
  return 0;
}
