// Machines in TOML: a file either describes a machine whose ways all lead from node to node, or is refused
// with a TopologyError that begins with its path.
#include <cmath>

#include "fuzz_scratch.h"
#include "runtime/machine_model.h"

namespace podm {
namespace {

using fuzz::check;

void check_model(const MachineModel& model) {
  check(model.clock_ghz > 0 && model.core_speed > 0 && model.miss_share >= 0 && model.miss_share <= 1);
  for (int from = 0; from < model.num_nodes(); ++from)
    for (int to = 0; to < model.num_nodes(); ++to) {
      check(std::isfinite(model.latency_s(from, to)) && model.latency_s(from, to) > 0);
      if (from == to) continue;
      check(model.route(from, to).front() == from && model.route(from, to).back() == to);
      check(model.topology.hops(from, to) > 0);
    }
}

}  // namespace
}  // namespace podm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  static const fuzz::ScratchFolder folder;
  const std::string path = folder.write("a.toml", fuzz::text_of(data, size));
  try {
    check_model(MachineModel::from_file(path));
  } catch (const TopologyError& error) {
    check(std::string_view(error.what()).starts_with(path));
  }
  return 0;
}
