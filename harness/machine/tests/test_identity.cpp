// Tests of processor identities from /proc/cpuinfo, and of the identity of this machine.
#include "machine/identity.h"

#include <gtest/gtest.h>

#include <sstream>

#include "machine/hwloc_topology.h"
#include "machine/machine.h"

namespace podm::bench {
namespace {

TEST(CpuInfo, OfX86) {
  std::istringstream lines(
      "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 17\nmodel name\t: AMD EPYC\n"
      "stepping\t: 1\n\nprocessor\t: 1\nmodel\t\t: 18\n");
  EXPECT_EQ(cpu_model_in(lines), (CpuModel{"AuthenticAMD", 25UL, 17UL, 1UL})) << "the first processor's";
}

TEST(CpuInfo, OfArmHasOtherKeys) {
  std::istringstream lines(
      "processor\t: 0\nCPU implementer\t: 0x41\nCPU architecture: 8\nCPU variant\t: 0x3\nCPU part\t: 0xd0c\n"
      "CPU revision\t: 1\n\nprocessor\t: 1\nCPU part\t: 0xd40\n");
  EXPECT_EQ(cpu_model_in(lines), (CpuModel{"0x41", 8UL, 0xd0cUL, 1UL})) << "the first processor's";
}

TEST(CpuInfo, SaysWhatItLacks) {
  std::istringstream nothing(""), broken("vendor_id : Some\ncpu family : many\nmodel : 3\n");
  EXPECT_TRUE(cpu_model_in(nothing).vendor.starts_with(Unavailable::kPrefix));
  const CpuModel cpu = cpu_model_in(broken);
  EXPECT_EQ(cpu.vendor, "Some");
  EXPECT_EQ(std::get<Unavailable>(cpu.family).why, "/proc/cpuinfo: 'cpu family' is 'many', not a number");
  EXPECT_EQ(cpu.model, Count(3UL));
  EXPECT_EQ(std::get<Unavailable>(cpu.stepping).why, "/proc/cpuinfo has no 'stepping'");
}

TEST(Identity, IsTheSameEachTimeAndComplete) {
  const Topology topology = load_topology();
  const IdentityRecord identity = identity_of(topology.get());
  EXPECT_EQ(identity, identity_of(topology.get()));
  EXPECT_EQ(identity, this_machine().summary.identity);
  EXPECT_GE(std::get<std::uint64_t>(identity.memory_gib), 1u);
  EXPECT_EQ(identity.kernel, kernel_name());
  EXPECT_TRUE(std::holds_alternative<Unavailable>(identity_of(nullptr).cache_bytes));
}

}  // namespace
}  // namespace podm::bench
