// Tests of processor identities from CPUID and /proc/cpuinfo, and of the identity of this machine.
#include "machine/identity.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "machine/hwloc_topology.h"
#include "machine/machine.h"

namespace podm::bench {
namespace {

CpuModel decoded(std::uint32_t signature) {
  // "GenuineIntel" lies in ebx, edx and ecx.
  return decode_cpuid({0, 0x756e6547, 0x6c65746e, 0x49656e69}, {signature, 0, 0, 0});
}

TEST(Cpuid, SignaturesOfKnownProcessors) {
  EXPECT_EQ(decoded(0x000c06f2), (CpuModel{"GenuineIntel", 6UL, 207UL, 2UL})) << "Emerald Rapids";
  EXPECT_EQ(decoded(0x00a10f11), (CpuModel{"GenuineIntel", 25UL, 17UL, 1UL})) << "Zen 4";
  EXPECT_EQ(decoded(0x00b00f21), (CpuModel{"GenuineIntel", 26UL, 2UL, 1UL})) << "Zen 5";
}

TEST(Cpuid, NoTwoSignaturesOfTheSameKindDecodeAlike) {
  for (std::uint32_t family = 15; family < 40; ++family)
    for (std::uint32_t model = 0; model < 256; model += 5)
      for (std::uint32_t stepping = 0; stepping < 16; stepping += 3) {
        const std::uint32_t signature =
            (family - 15) << 20 | (model >> 4) << 16 | 15U << 8 | (model & 15U) << 4 | stepping;
        EXPECT_EQ(decoded(signature), (CpuModel{"GenuineIntel", std::uint64_t{family}, std::uint64_t{model},
                                                std::uint64_t{stepping}}));
      }
}

TEST(Cpuid, AgreesWithTheKernel) {
  std::ifstream cpuinfo("/proc/cpuinfo");
  EXPECT_EQ(this_cpu_model(), cpu_model_in(cpuinfo));
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
