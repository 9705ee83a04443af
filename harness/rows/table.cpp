#include "rows/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "rows/record.h"
#include "rows/statistics.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;
using Line = std::vector<std::string>;
using Rows = std::vector<const Json*>;

constexpr double kBytesPerMib = 1024.0 * 1024;
// Phases outside the time of eq. (1): finding a radius, drawing a phantom, measuring the mesh, writing it.
constexpr const char* kNotMeshing[] = {"calibrate", "draw", "measure", "write"};

// What became of the repeats: the first fault where there is one.
std::string verdict(const Rows& repeats) {
  const auto is_ok = [](const Json* row) { return text_in(*row, "status") == to_string(Status::kOk); };
  const auto fault = std::find_if_not(repeats.begin(), repeats.end(), is_ok);
  if (fault != repeats.end()) {
    const std::string status = text_in(**fault, "status");
    return fmt::format("{}: {}", status == to_string(Status::kUnmet) ? "NOT met" : status,
                       text_in(**fault, "reason"));
  }
  if (repeats.front()->contains(kMemoryLevels)) return memory_levels(repeats);
  const Json verdicts = repeats.front()->value("verdicts", Json::object());
  const auto num_proved = std::count(verdicts.begin(), verdicts.end(), "pass");
  return num_proved > 0 ? fmt::format("met, {} claims proved", num_proved) : "met";
}

// "-" without any value.
std::string median_over(const Rows& rows, const std::function<std::optional<double>(const Json&)>& value_of,
                        const std::function<std::string(double)>& print) {
  std::vector<double> values;
  for (const Json* row : rows)
    if (const auto value = value_of(*row)) values.push_back(*value);
  return values.empty() ? "-" : print(median(std::move(values)));
}

std::string print_count(double count) { return thousands(static_cast<std::uint64_t>(count)); }

Line line_of(const Rows& repeats) {
  const Json& first = *repeats.front();
  Rows proved;
  for (const Json* row : repeats)
    if (text_in(*row, "status") == to_string(Status::kOk)) proved.push_back(row);
  const auto number = [](const char* key) { return [key](const Json& row) { return number_in(row, key); }; };
  const auto seconds = [](const Json& row) {
    return row.contains("phases_s") ? std::optional<double>(meshing_seconds(row)) : std::nullopt;
  };
  const auto of_process = [](const char* key) {
    return [key](const Json& row) { return number_in(row.value("process", Json::object()), key); };
  };
  return {text_in(first, "trial"),
          std::filesystem::path(text_in(first.value("input", Json::object()), "name")).filename().string(),
          std::to_string(repeats.size()),
          median_over(proved, number("cells"), print_count),
          median_over(proved, number("vertices"), print_count),
          median_over(proved, seconds, [](double s) { return fmt::format("{:.2f}", s); }),
          median_over(proved, number("refine_cells_per_second"), print_count),
          median_over(proved, of_process("peak_rss_bytes"),
                      [](double bytes) { return fmt::format("{:.0f}", bytes / kBytesPerMib); }),
          median_over(proved, of_process("bytes_per_cell_beyond_image"),
                      [](double bytes) { return fmt::format("{:.0f}", bytes); }),
          verdict(repeats)};
}

}  // namespace

std::string thousands(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t place = digits.size(); place > 3; place -= 3) digits.insert(place - 3, 1, ' ');
  return digits;
}

double meshing_seconds(const Json& record) {
  double seconds = 0;
  for (const auto& [phase, phase_s] : record["phases_s"].items())
    if (std::find(std::begin(kNotMeshing), std::end(kNotMeshing), phase) == std::end(kNotMeshing))
      seconds += phase_s.get<double>();
  return seconds;
}

std::string memory_levels(const std::vector<const Json*>& rows) {
  std::vector<std::string> parts;
  const Json& levels = (*rows.front())[kMemoryLevels];
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto cycles_of = [i](const Json& row) { return number_in(row[kMemoryLevels][i], "cycles"); };
    const auto print = [](double cycles) { return fmt::format("{:.3g} cycles", cycles); };
    parts.push_back(fmt::format("{} {}", text_in(levels[i], "module"), median_over(rows, cycles_of, print)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string align(const std::vector<Line>& lines, std::size_t num_text_columns) {
  std::vector<std::size_t> widths(lines.front().size());
  for (const Line& line : lines)
    for (std::size_t column = 0; column < line.size(); ++column)
      widths[column] = std::max(widths[column], line[column].size());
  std::string text;
  for (const Line& line : lines) {
    for (std::size_t column = 0; column + 1 < line.size(); ++column)
      text += column < num_text_columns ? fmt::format("{:<{}}  ", line[column], widths[column])
                                        : fmt::format("{:>{}}  ", line[column], widths[column]);
    text += line.back() + "\n";
  }
  return text;
}

std::string format_table(const std::vector<std::vector<Json>>& rows_of_trials) {
  std::vector<Line> lines{{"trial", "input", "runs", "cells", "vertices", "seconds", "refine cells/s",
                           "peak MiB", "bytes/cell", "guarantees"}};
  for (const std::vector<Json>& rows : rows_of_trials) {
    Rows repeats;
    for (const Json& row : rows)
      if (!row.value("warmup", false)) repeats.push_back(&row);
    if (!repeats.empty()) lines.push_back(line_of(repeats));
  }
  return align(lines, 2);
}

}  // namespace podm::bench
