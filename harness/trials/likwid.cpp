#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "machine/machine.h"
#include "process/ask.h"
#include "process/usable_processors.h"
#include "trials/counter_tool.h"

namespace podm::bench {
namespace {

constexpr const char* kProgram = "likwid-perfctr";
constexpr const char* kOutput = "/likwid.csv";

// The processors that this process may run on are counted.
std::vector<std::string> command_of(const std::string& events, const std::string& output) {
  return {kProgram, "-f",   "-c", fmt::format("{}", fmt::join(usable_processor_ids(), ",")),
          "-g",     events, "-o", output};
}

// Returns likwid's short name of this processor, which is the name of a folder of groups; empty when likwid
// has none.
std::string architecture() {
  std::istringstream lines(ask({kProgram, "-i"}).text);
  const std::string name = value_in(lines, "CPU short");
  return name == "nil" ? "" : name;
}

// Returns likwid-perfctr's refusal to count `events`, or a group of its own, in one line; empty: it counts.
std::string refusal_of(const std::string& events, const std::string& scratch_folder) {
  std::vector<std::string> command = command_of(events, scratch_folder + "/likwid_probe.csv");
  command.push_back("true");
  const Reply reply = ask(command);
  if (reply.succeeded()) return "";
  return fmt::format("{}: {}", kProgram,
                     reply.messages.empty() ? reply.outcome.describe() : reply.error_text());
}

// Returns the reason why there are no counts on a processor whose events likwid does not know. The program
// may report more than the missing name.
std::string refusal_of_processor(const std::string& group, const std::string& scratch_folder) {
  const std::string refusal = refusal_of(group, scratch_folder);
  return refusal.empty() ? fmt::format("{} does not know this processor", kProgram) : refusal;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

std::optional<double> number_of(const std::string& cell) {
  char* end = nullptr;
  const double number = std::strtod(cell.c_str(), &end);
  if (end == cell.c_str() || !std::isfinite(number)) return {};
  return number;
}

}  // namespace

std::string events_of_group(const std::string& path) {
  std::ifstream file(path);
  std::string events, line;
  while (std::getline(file, line) && line != "EVENTSET") continue;
  while (std::getline(file, line) && !line.empty()) {
    std::istringstream words(line);
    std::string counter, event;
    if (words >> counter >> event)
      events += fmt::format("{}{}:{}", events.empty() ? "" : ",", event, counter);
  }
  return events;
}

Likwid::Likwid(const std::string& group, const std::string& groups_folder, const std::string& scratch_folder)
    : group_(group) {
  if (!is_installed(kProgram)) {
    absence_ = fmt::format("{} is not installed", kProgram);
    return;
  }
  const std::string processor = architecture();
  const std::string path = fmt::format("{}/{}/{}.txt", groups_folder, processor, group);
  events_ = events_of_group(path);
  absence_ = processor.empty() ? refusal_of_processor(group, scratch_folder)
             : events_.empty() ? fmt::format("{} finds no events in {}", kProgram, path)
                               : refusal_of(events_, scratch_folder);
}

std::vector<std::string> Likwid::wrap(const std::vector<std::string>& command,
                                      const std::string& folder) const {
  std::vector<std::string> wrapped = command_of(events_, folder + kOutput);
  wrapped.insert(wrapped.end(), command.begin(), command.end());
  return wrapped;
}

// Reads lines EVENT,COUNTER,COUNT of each processor,... A count that is not a number was not taken.
Counters Likwid::read(const std::string& folder) const {
  std::ifstream file(folder + kOutput);
  const std::string events = "," + events_ + ",";
  std::map<std::string, double> sums;
  for (std::string line; std::getline(file, line);) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() < 3 || events.find(fmt::format(",{}:{},", cells[0], cells[1])) == std::string::npos)
      continue;
    for (std::size_t i = 2; i < cells.size(); ++i)
      if (const auto count = number_of(cells[i])) sums[cells[0]] += *count;
  }
  Counters counts;
  for (const auto& [event, sum] : sums)
    counts[event] = Counter{sum, fmt::format("{}, group {}", kProgram, group_), {}};
  if (counts.empty()) counts[kLikwid + group_] = Unavailable{"likwid-perfctr wrote no counts"};
  return counts;
}

std::unique_ptr<CounterTool> counter_tool(const std::string& choice, const std::string& groups_folder,
                                          const std::string& scratch_folder) {
  if (choice == kCachegrind) return std::make_unique<Cachegrind>();
  if (!choice.starts_with(kLikwid)) return {};
  return std::make_unique<Likwid>(choice.substr(std::strlen(kLikwid)), groups_folder, scratch_folder);
}

}  // namespace podm::bench
