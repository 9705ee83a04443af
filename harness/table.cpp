#include "table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "record.h"

namespace podm::bench {
namespace {

constexpr std::size_t kColumns = 9;
constexpr std::size_t kTextColumns = 2;  // aligned to the left; so is the last
using Line = std::array<std::string, kColumns>;

constexpr double kBytesPerMib = 1024.0 * 1024;

std::string thousands(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t place = digits.size(); place > 3; place -= 3) digits.insert(place - 3, 1, ' ');
  return digits;
}

std::string verdict(const TrialResult& result) {
  if (result.status == Status::kOk) {
    const std::size_t num_proved = result.record["verdicts"].size();
    return num_proved > 0 ? fmt::format("met, {} claims proved", num_proved) : "met";
  }
  return fmt::format("{}: {}", result.status == Status::kUnmet ? "NOT met" : to_string(result.status),
                     result.reason);
}

Line line_of(const Trial& trial, const TrialResult& result) {
  Line line;
  line.fill("-");
  line[0] = trial.name;
  line[1] = std::filesystem::path(trial.image).filename().string();
  line.back() = verdict(result);
  if (result.process.peak_rss_bytes > 0)
    line[6] = fmt::format("{:.0f}", static_cast<double>(result.process.peak_rss_bytes) / kBytesPerMib);
  if (!result.record.is_object()) return line;
  line[2] = thousands(result.record["cells"]);
  line[3] = thousands(result.record["vertices"]);
  line[4] = fmt::format("{:.2f}", meshing_seconds(result.record));
  line[5] = thousands(static_cast<std::uint64_t>(result.record["refine_cells_per_second"].get<double>()));
  if (const auto bytes = bytes_per_cell_beyond_image(result)) line[7] = fmt::format("{:.0f}", *bytes);
  return line;
}

}  // namespace

double meshing_seconds(const nlohmann::ordered_json& record) {
  double seconds = 0;
  for (const auto& [phase, phase_s] : record["phases_s"].items())
    if (phase != "write") seconds += phase_s.get<double>();
  return seconds;
}

std::string format_table(const std::vector<std::pair<Trial, TrialResult>>& results) {
  std::vector<Line> lines{{"trial", "input", "cells", "vertices", "seconds", "refine cells/s", "peak MiB",
                           "bytes/cell", "guarantees"}};
  for (const auto& [trial, result] : results) lines.push_back(line_of(trial, result));
  std::array<std::size_t, kColumns> widths{};
  for (const Line& line : lines)
    for (std::size_t column = 0; column < kColumns; ++column)
      widths[column] = std::max(widths[column], line[column].size());
  std::string text;
  for (const Line& line : lines) {
    for (std::size_t column = 0; column + 1 < kColumns; ++column)
      text += column < kTextColumns ? fmt::format("{:<{}}  ", line[column], widths[column])
                                    : fmt::format("{:>{}}  ", line[column], widths[column]);
    text += line.back() + "\n";
  }
  return text;
}

}  // namespace podm::bench
