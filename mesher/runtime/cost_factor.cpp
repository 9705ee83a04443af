#include "runtime/cost_factor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace podm {

namespace {

constexpr double kMostFactor = 1e3;

struct NamedConstant {
  const char* name;
  double MachineModel::*member;
  double usual = 0;  // multiplied where the machine has 0
};
// core_speed must not be 0, as work would never end. A hop_latency of 0 keeps the order of hops.
constexpr std::array<NamedConstant, 8> kOfMachine{{{"core_speed", &MachineModel::core_speed},
                                                   {"hop_latency", &MachineModel::hop_latency_s},
                                                   {"miss_share", &MachineModel::miss_share},
                                                   {"retries", &MachineModel::retries},
                                                   {"wake", &MachineModel::wake_s},
                                                   {"lock", &MachineModel::lock_s},
                                                   {"line_transfer", &MachineModel::line_transfer_s, 100e-9},
                                                   {"page_fault", &MachineModel::page_fault_s, 1e-6}}};
// The time that an access keeps a hub or a router busy. The first num_nodes() stations are hubs.
constexpr const char *kHubService = "hub_service", *kRouterService = "router_service";

bool is_known(const std::string& name) {
  const auto has_name = [&](const auto& constant) { return name == constant.name; };
  return std::any_of(kOfMachine.begin(), kOfMachine.end(), has_name) ||
         std::any_of(kTimeCosts.begin(), kTimeCosts.end(), has_name) || name == kHubService ||
         name == kRouterService;
}

std::string known_names() {
  std::string names;
  for (const auto& constant : kOfMachine) names += fmt::format("{}, ", constant.name);
  names += fmt::format("{}, {}", kHubService, kRouterService);
  for (const auto& constant : kTimeCosts) names += fmt::format(", {}", constant.name);
  return names;
}

}  // namespace

CostFactor CostFactor::parse(const std::string& text) {
  const std::size_t sign = text.find('=');
  CostFactor made{.name = text.substr(0, sign)};
  if (!is_known(made.name))
    throw TopologyError(fmt::format("unknown constant '{}': {}", made.name, known_names()));
  const char* const last = text.data() + text.size();
  const char* const first = sign == std::string::npos ? last : text.data() + sign + 1;
  const auto [end, error] = std::from_chars(first, last, made.factor);
  if (error != std::errc() || end != last || !(made.factor >= 0 && made.factor <= kMostFactor))
    throw TopologyError(fmt::format("'{}' is not NAME=FACTOR with a factor from 0 to {}", text, kMostFactor));
  if (made.factor == 0 && made.name == kOfMachine.front().name)
    throw TopologyError("core_speed needs a factor above 0: a run on cores of speed 0 would never end");
  return made;
}

void CostFactor::apply_to(MachineModel& machine) const {
  for (const auto& constant : kOfMachine)
    if (double& value = machine.*constant.member; name == constant.name)
      value = factor * (value > 0 ? value : constant.usual);
  for (const auto& constant : kTimeCosts)
    if (name == constant.name) machine.costs.*constant.member *= factor;
  const auto num_hubs = static_cast<std::size_t>(machine.num_nodes());
  for (std::size_t station = 0; station < machine.stations.size(); ++station)
    if (name == (station < num_hubs ? kHubService : kRouterService))
      machine.stations[station].service_s *= factor;
  if (machine.miss_share > 1 || machine.costs.spread > 1)
    throw TopologyError(fmt::format("{} times {} is a share above 1", name, factor));
}

}  // namespace podm
