#include "machine/environment.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <hwloc.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "machine/machine.h"
#include "process/ask.h"
#include "process/sha256.h"
#include "runtime/control_group.h"

namespace podm::bench {
namespace {

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) ? line : "unavailable: no " + path;
}

std::variant<std::vector<double>, Unavailable> load_average() {
  std::vector<double> minutes_1_5_15(3);
  if (getloadavg(minutes_1_5_15.data(), 3) != 3) return Unavailable{"getloadavg"};
  return minutes_1_5_15;
}

// Returns the limit of this process's own group. `unified` and `legacy` are its files in versions 2 and 1.
std::string limit_in_group(const std::string& controller, const std::string& unified,
                           const std::vector<std::string>& legacy) {
  const ControlGroup group = control_group_of(controller);
  if (group.folders.empty()) return "unavailable: no control group of " + controller;
  if (group.is_unified) return first_line(group.folders.front() + unified);
  std::vector<std::string> lines;
  for (const std::string& file : legacy) lines.push_back(first_line(group.folders.front() + file));
  return fmt::format("{}", fmt::join(lines, " "));
}

// Returns the smallest limit of all enclosing groups, in bytes.
std::string memory_limit() {
  if (control_group_of("memory").folders.empty()) return "unavailable: no control group of memory";
  const std::uint64_t bytes = memory_limit_of_control_groups();
  return bytes == kNoLimit ? "max" : fmt::format("{}", bytes);
}

ControlGroupLimits cgroup_limits() {
  return {limit_in_group("cpu", "/cpu.max", {"/cpu.cfs_quota_us", "/cpu.cfs_period_us"}),
          limit_in_group("cpuset", "/cpuset.cpus.effective", {"/cpuset.effective_cpus"}), memory_limit()};
}

std::variant<Sources, Unavailable> sources() {
  const Reply commit = ask({"git", "-C", PODM_SOURCE_DIR, "rev-parse", "HEAD"}),
              changes = ask({"git", "-C", PODM_SOURCE_DIR, "status", "--porcelain", "--untracked-files=no"});
  if (!commit.succeeded() || !changes.succeeded())
    return Unavailable{"the sources are not in a git checkout"};
  return Sources{commit.text, !changes.text.empty()};
}

// Reads the remaining lines, "key: value".
ByName<std::string> build_of(std::istringstream& lines) {
  ByName<std::string> build;
  for (std::string line; std::getline(lines, line);)
    if (const auto colon = line.find(": "); colon != std::string::npos)
      build[line.substr(0, colon)] = line.substr(colon + 2);
  return build;
}

// The program prints a line with its name and version, then lines about its build.
ProgramRecord describe_program(const std::string& path) {
  const Reply reply = ask({path, "--version"});
  std::istringstream lines(reply.succeeded() ? reply.text : "unavailable: --version fails");
  std::string version;
  std::getline(lines, version);
  ProgramRecord program{sha256_of_file(path), version, Unavailable{"--version reports no build"}};
  if (auto build = build_of(lines); !build.empty()) program.build = std::move(build);
  return program;
}

}  // namespace

EnvironmentRecord environment_of_run(const MachineRecord& machine) {
  EnvironmentRecord environment;
  static_cast<MachineRecord&>(environment) = machine;
  environment.kernel = kernel_name();
  environment.smt = first_line("/sys/devices/system/cpu/smt/control");
  environment.cgroup = cgroup_limits();
  environment.libraries = {{"glibc", gnu_get_libc_version()},
                           {"hwloc", fmt::format("{:#x}", hwloc_get_api_version())}};
  environment.compiler = PODM_COMPILER;
  environment.compiler_flags = PODM_COMPILER_FLAGS;
  environment.build_type = PODM_BUILD_TYPE;
  environment.sources = sources();
  return environment;
}

void renew(EnvironmentRecord& environment) {
  environment.load_average = load_average();
  environment.memory_bytes = {meminfo_bytes("MemTotal"), meminfo_bytes("MemAvailable")};
  environment.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  environment.transparent_huge_pages = first_line("/sys/kernel/mm/transparent_hugepage/enabled");
  environment.numa_balancing = first_line("/proc/sys/kernel/numa_balancing");
}

ProgramRecords describe_programs(const Programs& programs) {
  ProgramRecords described{describe_program(programs.podm), ProgramRecords::kNone, {}, {}};
  if (const std::string program = podm_mpi_of(programs.podm); std::filesystem::exists(program))
    described.podm_mpi = describe_program(program);
  if (!programs.verifier.empty()) described.podm_verify = describe_program(programs.verifier);
  return described;
}

}  // namespace podm::bench
