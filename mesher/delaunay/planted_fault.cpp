#include "delaunay/planted_fault.h"

#include <array>
#include <cstdlib>
#include <string>

#include "podm/errors.h"

namespace podm {

namespace {

struct Fault {
  const char* name = "";
  LocksTaken locks = {};
  OrderedAccess relaxed = OrderedAccess::kNone;
};

constexpr std::array kFaults{Fault{.name = "no_lock", .locks = {.to_read = 0}},
                             Fault{.name = "one_lock", .locks = {.to_read = 1}},
                             Fault{.name = "three_locks", .locks = {.to_replace = 3}},
                             Fault{.name = "three_in_zone", .locks = {.in_zone = 3}},
                             Fault{.name = "three_to_move", .locks = {.to_move = 3}},
                             Fault{.name = "three_in_cavity", .locks = {.in_cavity = 3}},
                             Fault{.name = "two_to_look_up", .locks = {.to_look_up = 2}},
                             Fault{.name = "not_ordered", .locks = {.to_order = 0}},
                             Fault{.name = "relaxed_lock", .relaxed = OrderedAccess::kLock},
                             Fault{.name = "relaxed_unlock", .relaxed = OrderedAccess::kUnlock},
                             Fault{.name = "relaxed_peek_point", .relaxed = OrderedAccess::kPeekPoint},
                             Fault{.name = "relaxed_place", .relaxed = OrderedAccess::kPlace},
                             Fault{.name = "relaxed_peek_cell", .relaxed = OrderedAccess::kPeekCell},
                             Fault{.name = "relaxed_renew", .relaxed = OrderedAccess::kRenew}};

Fault named_in_environment() {
  const char* const asked = std::getenv("PODM_PLANTED_FAULT");
  if (asked == nullptr) return {};
  std::string names;
  for (const Fault& fault : kFaults) {
    if (asked == std::string(fault.name)) return fault;
    names += std::string(" ") + fault.name;
  }
  throw InputError("PODM_PLANTED_FAULT: unknown fault '" + std::string(asked) + "'; known faults:" + names);
}

Fault& planted() {
  static Fault fault = named_in_environment();
  return fault;
}

}  // namespace

LocksTaken locks_taken() { return planted().locks; }
void plant_fault(LocksTaken locks) { planted().locks = locks; }
std::memory_order order_of(OrderedAccess access, std::memory_order order) {
  return planted().relaxed == access ? std::memory_order_relaxed : order;
}

}  // namespace podm
