// Checks that a factor changes the constant that it names and nothing else.
#include "runtime/cost_factor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/fault_of.h"

namespace podm::test {
namespace {

using testing::HasSubstr;

MachineModel blacklight() { return MachineModel::from_file(PODM_MACHINES + std::string("/blacklight.toml")); }
// A machine with every constant.
MachineModel machine_with_all() {
  MachineModel machine = blacklight();
  machine.line_transfer_s = 30e-9;
  machine.page_fault_s = 2e-6;
  return machine;
}

// Returns all constants that costs depend on, by the names that factors use.
std::map<std::string, double> constants_of(const MachineModel& machine) {
  std::map<std::string, double> constants{{"core_speed", machine.core_speed},
                                          {"hop_latency", machine.hop_latency_s},
                                          {"miss_share", machine.miss_share},
                                          {"retries", machine.retries},
                                          {"wake", machine.wake_s},
                                          {"lock", machine.lock_s},
                                          {"line_transfer", machine.line_transfer_s},
                                          {"page_fault", machine.page_fault_s}};
  for (const auto& [name, member] : kTimeCosts) constants[name] = machine.costs.*member;
  for (const MachineModel::Station& station : machine.stations)
    constants[station.name.starts_with("node") ? "hub_service" : "router_service"] = station.service_s;
  return constants;
}

TEST(CostFactor, ChangesTheConstantThatItNamesAlone) {
  const auto plain = constants_of(machine_with_all());
  EXPECT_EQ(plain.size(), 10 + kTimeCosts.size());
  for (const auto& [changed, value] : plain) {
    EXPECT_GT(value, 0) << changed;
    MachineModel machine = machine_with_all();
    CostFactor::parse(changed + "=2").apply_to(machine);
    for (const auto& [name, now] : constants_of(machine))
      EXPECT_DOUBLE_EQ(now, plain.at(name) * (name == changed ? 2 : 1)) << changed << ", " << name;
    EXPECT_EQ(machine.topology.hops(0, 5), blacklight().topology.hops(0, 5)) << changed;
  }
}

TEST(CostFactor, OfZeroSwitchesOff) {
  MachineModel machine = blacklight();
  CostFactor::parse("router_service=0").apply_to(machine);
  CostFactor::parse("leaf_handed_out=0").apply_to(machine);
  EXPECT_EQ(machine.stations.back().service_s, 0);
  EXPECT_GT(machine.stations.front().service_s, 0);
  EXPECT_EQ(machine.costs.leaf_handed_out, 0);
}

TEST(CostFactor, OfACostOfSharingThatTheMachineLacksMultipliesTheUsualOne) {
  MachineModel machine = blacklight();
  CostFactor::parse("line_transfer=2").apply_to(machine);
  CostFactor::parse("page_fault=0.25").apply_to(machine);
  EXPECT_DOUBLE_EQ(machine.line_transfer_s, 200e-9);
  EXPECT_DOUBLE_EQ(machine.page_fault_s, 0.25e-6);
  CostFactor::parse("line_transfer=0").apply_to(machine);
  EXPECT_EQ(machine.line_transfer_s, 0);
}

TEST(CostFactor, RefusesWhatIsNone) {
  const auto fault = [](const std::string& text) {
    return fault_of<TopologyError>([&] { CostFactor::parse(text); });
  };
  EXPECT_THAT(fault("speed=2"), HasSubstr("unknown constant 'speed': core_speed, "));
  for (const std::string text :
       {"retries", "retries=", "retries=a", "retries=2x", "retries=-1", "retries=1e4", "retries=nan"})
    EXPECT_THAT(fault(text), HasSubstr("is not NAME=FACTOR")) << text;
  EXPECT_THAT(fault("core_speed=0"), HasSubstr("would never end"));
  MachineModel machine = blacklight();
  EXPECT_THAT(fault_of<TopologyError>([&] { CostFactor::parse("miss_share=50").apply_to(machine); }),
              HasSubstr("above 1"));
}

}  // namespace
}  // namespace podm::test
