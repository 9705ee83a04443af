#include "cli/crossover.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "algorithms/team_size.h"
#include "cli/options/option_values.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "podm-crossover/2";

std::string this_cpu() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name"))
      if (const auto begin = line.find_first_not_of(" \t", line.find(':') + 1); begin != std::string::npos)
        return line.substr(begin);
  return {};
}

bool is_threads(const Json& value) {
  return value.is_number_unsigned() && value >= 1U && value <= static_cast<unsigned>(kMaxThreads);
}

// Returns the reason why the file is not one of podm-bench; empty if it is one.
std::string fault_of(const Json& file) {
  if (!file.is_object()) return "is no JSON object";
  if (file.value("schema", Json()) != kSchema) return fmt::format("is not of schema {}", kSchema);
  if (!is_threads(file.value("measured_up_to", Json()))) return "has no number of threads 'measured_up_to'";
  const Json threads = file.value("threads", Json(""));
  if (!threads.is_null() && !is_threads(threads)) return "has neither a number nor null as 'threads'";
  if (!file.value(Json::json_pointer("/machine/cpu"), Json()).is_string())
    return "has no 'machine' with a 'cpu'";
  return {};
}

// If kPodmHome was never faster, the result is kPodm up to the largest number of threads measured.
Crossover read_crossover(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) throw InputError(fmt::format("{}: cannot be read as a crossover of podm-bench", path));
  const Json file = Json::parse(stream, nullptr, false);
  if (const std::string fault = fault_of(file); !fault.empty())
    throw InputError(
        fmt::format("{}: {}; podm-bench run experiments/crossover.toml writes one", path, fault));
  const Json measured = file["threads"], up_to = file["measured_up_to"], machine = file["machine"];
  Crossover result;
  result.threads = measured.is_null() ? up_to.get<int>() + 1 : measured.get<int>();
  result.source = {{"source", "file"},
                   {"path", path},
                   {"measured", measured},
                   {"measured_up_to", up_to},
                   {"machine", machine}};
  if (const std::string cpu = machine["cpu"], here = this_cpu(); cpu != here)
    result.warning = fmt::format("{} was measured on {}, this is {}", path, cpu, here);
  return result;
}

bool is_number(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return ('0' <= c && c <= '9') || c == '-'; });
}

Crossover find_crossover(const MeshCommand& command) {
  const std::string& asked = command.crossover;
  const char* const stored = std::getenv(kCrossoverVariable);
  if (asked.empty()) {
    const bool is_used =
        command.meshing.algorithm == Algorithm::kAuto && is_of_this_machine(command.meshing.team);
    if (!is_used || stored == nullptr || *stored == 0)
      return {.threads = 0, .source = {{"source", "default"}}, .warning = {}};
    return read_crossover(stored);
  }
  if (!is_number(asked)) return read_crossover(asked);
  const auto threads = static_cast<int>(parse_integer(asked, "--crossover", 1, kMaxThreads));
  return {.threads = threads, .source = {{"source", "option"}}, .warning = {}};
}

}  // namespace

Crossover choose_crossover(const MeshCommand& command) {
  Crossover found = find_crossover(command);
  found.source["threads"] = found.threads > 0 ? Json(found.threads) : Json();
  return found;
}

}  // namespace podm::cli
