#include "rows/machine_state.h"

namespace podm::bench {
namespace {

constexpr double kMostBusyElsewhere = 0.1;  // of each usable processor

}  // namespace

bool is_disturbed(const Row& row) {
  const auto& environment = row.environment;
  return environment.busy_elsewhere.value_or(0) > kMostBusyElsewhere * environment.usable_processors;
}

bool probe_moved(const Row& row) { return row.probe_moved.value_or(false); }

}  // namespace podm::bench
