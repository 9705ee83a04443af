#include "delaunay/planted_fault.h"

#include <array>
#include <cstdlib>
#include <string>
#include <utility>

#include "podm/errors.h"

namespace podm {

namespace {

constexpr std::array kFaults{std::pair{"no_lock", LocksTaken{.to_read = 0}},
                             std::pair{"one_lock", LocksTaken{.to_read = 1}},
                             std::pair{"three_locks", LocksTaken{.to_replace = 3}},
                             std::pair{"three_in_zone", LocksTaken{.in_zone = 3}},
                             std::pair{"three_to_move", LocksTaken{.to_move = 3}},
                             std::pair{"three_in_cavity", LocksTaken{.in_cavity = 3}}};

LocksTaken named_in_environment() {
  const char* const asked = std::getenv("PODM_PLANTED_FAULT");
  if (asked == nullptr) return {};
  std::string names;
  for (const auto& [name, locks] : kFaults) {
    if (asked == std::string(name)) return locks;
    names += std::string(" ") + name;
  }
  throw InputError("PODM_PLANTED_FAULT: unknown fault '" + std::string(asked) + "'; known faults:" + names);
}

LocksTaken& planted() {
  static LocksTaken locks = named_in_environment();
  return locks;
}

}  // namespace

LocksTaken locks_taken() { return planted(); }
void plant_fault(LocksTaken locks) { planted() = locks; }

}  // namespace podm
