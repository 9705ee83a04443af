#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "process/process.h"
#include "trials/counter_tool.h"

namespace podm::bench {
namespace {

constexpr const char* kOutput = "/cachegrind.out";
// The caches of a core of the paper's machine: 32 KiB, and 2 MiB as its share of the last level. They are
// always the same, so that runs on different machines compare, and small enough for the small meshes that are
// simulated.
constexpr const char *kL1Instructions = "32768,4,64", *kL1Data = "32768,8,64", *kLastLevel = "2097152,16,64";
constexpr const char* kSource = "valgrind cachegrind (simulated: L1 32 KiB, 8-way; last level 2 MiB, 16-way)";

// kNames stands in the order of kCachegrindEvents.
constexpr const char* kCachegrindEvents = "Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw";
constexpr std::array<const char*, 9> kNames = {
    "instructions", "l1_instruction_misses", "llc_instruction_misses",
    "loads",        "l1_load_misses",        "llc_load_misses",
    "stores",       "l1_store_misses",       "llc_store_misses"};

// Returns the text after "key: "; empty when no line has the key.
std::string line_of(std::ifstream& file, const std::string& key) {
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key + ":")) return line.substr(std::min(line.size(), key.size() + 2));
  return {};
}

std::string without_last_space(std::string text) {
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace

std::string Cachegrind::absence() const {
  return is_installed("valgrind") ? "" : "valgrind is not installed";
}

std::vector<std::string> Cachegrind::wrap(const std::vector<std::string>& command,
                                          const std::string& folder) const {
  std::vector<std::string> wrapped{"valgrind",
                                   "--quiet",
                                   "--tool=cachegrind",
                                   "--cache-sim=yes",
                                   fmt::format("--I1={}", kL1Instructions),
                                   fmt::format("--D1={}", kL1Data),
                                   fmt::format("--LL={}", kLastLevel),
                                   fmt::format("--cachegrind-out-file={}{}", folder, kOutput)};
  wrapped.insert(wrapped.end(), command.begin(), command.end());
  return wrapped;
}

Counters Cachegrind::read(const std::string& folder) const {
  std::ifstream file(folder + kOutput);
  if (without_last_space(line_of(file, "events")) != kCachegrindEvents)
    return {{kCachegrind, Unavailable{"valgrind wrote no counts of caches"}}};
  std::istringstream totals(line_of(file, "summary"));
  Counters counts;
  for (const char* name : kNames) {
    std::uint64_t value = 0;
    if (!(totals >> value)) return {{kCachegrind, Unavailable{"valgrind wrote no totals"}}};
    counts[name] = Counter{value, kSource, {}};
  }
  return counts;
}

}  // namespace podm::bench
