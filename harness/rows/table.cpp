#include "rows/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "rows/measure.h"
#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

using Line = std::vector<std::string>;
using Rows = std::vector<const Row*>;

constexpr const char* kRates =
    "whole: from the input in memory to the mesh in memory. refining: without feature transform, allocation, "
    "extraction,\nthe domain that CGAL prepares, and the surface that TetGen and HXT are given.\n";
constexpr double kBytesPerMib = 1024.0 * 1024;

// "-" if there is no value.
template <class T>
std::string median_over(const std::vector<const T*>& all,
                        const std::function<std::optional<double>(const T&)>& value_of,
                        const std::function<std::string(double)>& print) {
  std::vector<double> values;
  for (const T* one : all)
    if (const auto value = value_of(*one)) values.push_back(*value);
  return values.empty() ? "-" : print(median(std::move(values)));
}

std::string memory_levels_of(const Rows& rows) {
  std::vector<const MemoryLevelsRecord*> records;
  for (const Row* row : rows) records.push_back(&*row->measured);
  return memory_levels(records);
}

// "met, 9 claims proved". For a mesher that promises some of the claims, the text has the number of promised
// claims that it kept.
std::string proofs_of(const MeshRecord& mesh) {
  const ByName<Proof> verdicts = mesh.verdicts.value_or(ByName<Proof>{});
  const auto num_proved = std::count_if(verdicts.begin(), verdicts.end(),
                                        [](const auto& verdict) { return verdict.second == Proof::kPass; });
  if (num_proved == 0) return "met";
  if (!mesh.promises) return fmt::format("met, {} claims proved", num_proved);
  const auto num_kept = std::count_if(mesh.promises->begin(), mesh.promises->end(), [&](const auto& claim) {
    const Proof* const proof = verdicts.find(claim);
    return proof != nullptr && *proof == Proof::kPass;
  });
  return fmt::format("met, {} of {} claims proved, {} of {} promised ones", num_proved, verdicts.size(),
                     num_kept, mesh.promises->size());
}

// Returns the outcome of the repeats: the first fault if there is one.
std::string verdict(const Rows& repeats) {
  for (const Row* row : repeats)
    if (row->status != Status::kOk)
      return fmt::format("{}: {}", row->status == Status::kUnmet ? "NOT met" : to_string(row->status),
                         row->reason);
  if (repeats.front()->measured) return memory_levels_of(repeats);
  const auto& mesh = repeats.front()->mesh;
  return mesh ? proofs_of(*mesh) : "met";
}

std::string print_count(double count) { return thousands(static_cast<std::uint64_t>(count)); }

Line line_of(const Rows& repeats) {
  using Number = std::optional<double>;
  Rows proved;
  for (const Row* row : repeats)
    if (row->status == Status::kOk) proved.push_back(row);
  const auto measured = [&proved](const char* name) {
    const Measure& measure = *find_measure(name);
    return median_over<Row>(
        proved, [&](const Row& row) { return measure.read(row).number; }, print_count);
  };
  const auto over_meshes = [&proved](const auto& number_of, const auto& print) {
    return median_over<Row>(
        proved, [&](const Row& row) { return row.mesh ? Number(number_of(*row.mesh)) : Number(); }, print);
  };
  const auto seconds = [](const MeshRecord& mesh) { return meshing_seconds(mesh.phases_s); };
  return {repeats.front()->trial,
          std::filesystem::path(repeats.front()->input.name).filename().string(),
          std::to_string(repeats.size()),
          over_meshes([](const MeshRecord& mesh) { return mesh.cells; }, print_count),
          over_meshes([](const MeshRecord& mesh) { return mesh.vertices; }, print_count),
          measured("boundary_facets"),
          over_meshes(seconds, [](double s) { return fmt::format("{:.2f}", s); }),
          measured("whole_cells_per_second"),
          measured("refining_cells_per_second"),
          median_over<Row>(
              proved, [](const Row& row) { return Number(row.process.peak_rss_bytes); },
              [](double bytes) { return fmt::format("{:.0f}", bytes / kBytesPerMib); }),
          median_over<Row>(
              proved, [](const Row& row) { return row.process.bytes_per_cell_beyond_image; },
              [](double bytes) { return fmt::format("{:.0f}", bytes); }),
          verdict(repeats)};
}

}  // namespace

std::string thousands(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t place = digits.size(); place > 3; place -= 3) digits.insert(place - 3, 1, ' ');
  return digits;
}

std::string memory_levels(const std::vector<const MemoryLevelsRecord*>& records) {
  std::vector<std::string> parts;
  const auto& levels = records.front()->memory_levels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto cycles_of = [i](const MemoryLevelsRecord& record) -> std::optional<double> {
      const auto* const cycles = std::get_if<double>(&record.memory_levels.at(i).cycles);
      return cycles == nullptr ? std::nullopt : std::optional(*cycles);
    };
    const auto print = [](double cycles) { return fmt::format("{:.3g} cycles", cycles); };
    parts.push_back(
        fmt::format("{} {}", levels[i].module, median_over<MemoryLevelsRecord>(records, cycles_of, print)));
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

std::string format_table(const std::vector<std::vector<Row>>& rows_of_trials) {
  std::vector<Line> lines{{"trial", "input", "runs", "cells", "vertices", "facets", "seconds",
                           "whole cells/s", "refining cells/s", "peak MiB", "bytes/cell", "guarantees"}};
  bool has_rates = false;
  for (const std::vector<Row>& rows : rows_of_trials) {
    Rows repeats;
    for (const Row& row : rows)
      if (!row.warmup) repeats.push_back(&row);
    if (repeats.empty()) continue;
    lines.push_back(line_of(repeats));
    has_rates = has_rates || repeats.front()->mesh;
  }
  return align(lines, 2) + (has_rates ? kRates : "");
}

}  // namespace podm::bench
