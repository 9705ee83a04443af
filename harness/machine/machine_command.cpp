#include <fmt/format.h>

#include "machine/commands.h"
#include "machine/machine.h"
#include "machine/probe.h"
#include "rows/codec.h"
#include "rows/machine_state.h"

namespace podm::bench {
namespace {

std::string in_words(const Probe& probe) {
  const auto* const values = std::get_if<ProbeRecord>(&probe);
  if (values == nullptr) return std::get<Unavailable>(probe).text();
  return fmt::format("{:.1f} ns per random load, {:.1f} GB/s of triad, {:.3f} ns per addition",
                     values->chase_ns, values->triad_gb_per_s, values->integer_ns);
}

}  // namespace

int show_machine(bool as_json) {
  Row row;
  static_cast<MachineRecord&>(row.environment) = this_machine().summary;
  row.environment.probe = probe_machine();
  if (as_json) {
    Json json = to_json(static_cast<const MachineRecord&>(row.environment));
    json["probe"] = to_json(row.environment.probe);
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print("machine: {}\nprobe: {}\n", machine_name(row), in_words(*row.environment.probe));
  }
  return 0;
}

}  // namespace podm::bench
