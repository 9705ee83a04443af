#include "environment.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "process.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kGitTimeoutS = 30;
constexpr std::size_t kMaxGitBytes = 4096;

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) ? line : "unavailable: no " + path;
}

// The text after the colon of the first line "key : text".
std::string value_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key))
      if (const auto begin = line.find_first_not_of(" \t", line.find(':') + 1); begin != std::string::npos)
        return line.substr(begin);
  return fmt::format("unavailable: {} does not tell '{}'", path, key);
}

// From a line "key: 123 kB".
Json bytes_of(const std::string& key) {
  const std::string text = value_of("/proc/meminfo", key);
  if (text.starts_with("unavailable")) return text;
  return 1024 * std::stoull(text);
}

Json cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  Json usable = "unavailable: no affinity";
  if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0) usable = CPU_COUNT(&allowed);
  return {{"online", sysconf(_SC_NPROCESSORS_ONLN)}, {"usable", usable}};
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

// What `git ARGUMENTS` prints about the sources; false when it fails.
bool ask_git(std::vector<std::string> arguments, const std::string& scratch_folder, std::string& answer) {
  const std::string path = scratch_folder + "/git.txt";
  arguments.insert(arguments.begin(), {"git", "-C", PODM_SOURCE_DIR});
  const ProcessOutcome git = run_process(
      {.arguments = arguments, .stdout_path = path, .stderr_path = {}, .timeout_s = kGitTimeoutS});
  answer = read_tail(path, kMaxGitBytes);
  while (answer.ends_with('\n')) answer.pop_back();
  return git.succeeded();
}

Json sources(const std::string& scratch_folder) {
  std::string commit, changes;
  if (!ask_git({"rev-parse", "HEAD"}, scratch_folder, commit) ||
      !ask_git({"status", "--porcelain", "--untracked-files=no"}, scratch_folder, changes))
    return "unavailable: the sources are in no git checkout";
  return {{"commit", commit}, {"dirty", !changes.empty()}};
}

}  // namespace

Json environment(const std::string& scratch_folder) {
  return {
      {"cpu", value_of("/proc/cpuinfo", "model name")},
      {"cores", cores()},
      {"governor", first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")},
      {"transparent_huge_pages", first_line("/sys/kernel/mm/transparent_hugepage/enabled")},
      {"kernel", kernel()},
      {"load_average", load_average()},
      {"memory_bytes", {{"total", bytes_of("MemTotal")}, {"available", bytes_of("MemAvailable")}}},
      {"compiler", PODM_COMPILER},
      {"compiler_flags", PODM_COMPILER_FLAGS},
      {"build_type", PODM_BUILD_TYPE},
      {"sources", sources(scratch_folder)},
  };
}

}  // namespace podm::bench
