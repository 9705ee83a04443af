#include "machine/environment.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <hwloc.h>
#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "machine/machine.h"
#include "runtime/control_group.h"
#include "trials/ask.h"
#include "trials/sha256.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) ? line : "unavailable: no " + path;
}

// From a line "key: 123 kB".
Json bytes_of(const std::string& key) {
  const std::string text = value_of("/proc/meminfo", key);
  if (text.starts_with("unavailable")) return text;
  return 1024 * std::stoull(text);
}

Json load_average() {
  double minutes_1_5_15[3];
  if (getloadavg(minutes_1_5_15, 3) != 3) return "unavailable: getloadavg";
  return minutes_1_5_15;
}

std::string kernel() {
  utsname name{};
  uname(&name);
  return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

// Of this process's own group; `unified` and `legacy` are its files in versions 2 and 1.
std::string limit_in_group(const std::string& controller, const std::string& unified,
                           const std::vector<std::string>& legacy) {
  const ControlGroup group = control_group_of(controller);
  if (group.folders.empty()) return "unavailable: no control group of " + controller;
  if (group.is_unified) return first_line(group.folders.front() + unified);
  std::vector<std::string> lines;
  for (const std::string& file : legacy) lines.push_back(first_line(group.folders.front() + file));
  return fmt::format("{}", fmt::join(lines, " "));
}

// The least of all groups around, in bytes.
std::string memory_limit() {
  if (control_group_of("memory").folders.empty()) return "unavailable: no control group of memory";
  const std::uint64_t bytes = memory_limit_of_control_groups();
  return bytes == kNoLimit ? "max" : fmt::format("{}", bytes);
}

Json cgroup_limits() {
  return {{"cpu_max", limit_in_group("cpu", "/cpu.max", {"/cpu.cfs_quota_us", "/cpu.cfs_period_us"})},
          {"cpuset", limit_in_group("cpuset", "/cpuset.cpus.effective", {"/cpuset.effective_cpus"})},
          {"memory_max", memory_limit()}};
}

Json sources() {
  const Reply commit = ask({"git", "-C", PODM_SOURCE_DIR, "rev-parse", "HEAD"}),
              changes = ask({"git", "-C", PODM_SOURCE_DIR, "status", "--porcelain", "--untracked-files=no"});
  if (!commit.succeeded() || !changes.succeeded()) return "unavailable: the sources are in no git checkout";
  return {{"commit", commit.text}, {"dirty", !changes.text.empty()}};
}

// Of the lines "key: value".
Json build_of(std::istringstream& lines) {
  Json build = Json::object();
  for (std::string line; std::getline(lines, line);)
    if (const auto colon = line.find(": "); colon != std::string::npos)
      build[line.substr(0, colon)] = line.substr(colon + 2);
  return build;
}

// What it prints is a line of name and version and then lines of its build.
Json describe_program(const std::string& path) {
  const Reply reply = ask({path, "--version"});
  std::istringstream lines(reply.succeeded() ? reply.text : "unavailable: --version fails");
  std::string version;
  std::getline(lines, version);
  const Json build = build_of(lines);
  return {{"sha256", sha256_of_file(path)},
          {"version", version},
          {"build", build.empty() ? Json("unavailable: --version tells nothing of it") : build}};
}

}  // namespace

Json environment_of_run() {
  return {
      {"kernel", kernel()},
      {"smt", first_line("/sys/devices/system/cpu/smt/control")},
      {"cgroup", cgroup_limits()},
      {"libraries",
       {{"glibc", gnu_get_libc_version()}, {"hwloc", fmt::format("{:#x}", hwloc_get_api_version())}}},
      {"compiler", PODM_COMPILER},
      {"compiler_flags", PODM_COMPILER_FLAGS},
      {"build_type", PODM_BUILD_TYPE},
      {"sources", sources()},
  };
}

Json environment_now() {
  return {
      {"load_average", load_average()},
      {"memory_bytes", {{"total", bytes_of("MemTotal")}, {"available", bytes_of("MemAvailable")}}},
      {"governor", first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")},
      {"transparent_huge_pages", first_line("/sys/kernel/mm/transparent_hugepage/enabled")},
      {"numa_balancing", first_line("/proc/sys/kernel/numa_balancing")},
  };
}

Json describe_programs(const Programs& programs) {
  Json described = {{"podm", describe_program(programs.podm)}};
  described["podm_verify"] = programs.verifier.empty() ? Json("none") : describe_program(programs.verifier);
  return described;
}

}  // namespace podm::bench
