// Seconds of the phases, and rates.
#include "rows/measure_parts.h"

#include <nlohmann/json.hpp>

namespace podm::bench {
namespace {

Value threads(const Row& row) {
  const Json threads = asked_of(row).value("threads", Json());
  return threads.is_number() ? Value{threads.get<double>(), ""} : absent("rows have no asked/threads");
}

Value seconds(const Row& row) {
  return row.mesh ? Value{meshing_seconds(row.mesh->phases_s), ""} : absent("rows have no phases_s");
}

// Refining consists of these phases. A phase that an algorithm does not have costs nothing.
Value refining_seconds_of(const ByName<double>& phases_s) {
  if (phases_s.find("refine") == nullptr) return absent("rows have no phases_s/refine");
  double sum = 0;
  for (const char* phase : {"refine", "initial", "octree", "closing"})
    if (const double* phase_s = phases_s.find(phase)) sum += *phase_s;
  return {sum, ""};
}
Value refining_seconds(const Row& row) {
  return row.mesh ? refining_seconds_of(row.mesh->phases_s) : absent("rows have no phases_s");
}

// From the input in memory to the mesh in memory: eq. (1) without reading. For a mesher that begins with a
// finished surface the making of that surface counts, too.
Value whole_seconds(const Row& row) {
  const Value all = seconds(row);
  if (!all.number) return all;
  const double* const read_s = row.mesh->phases_s.find("read");
  return {*all.number - (read_s == nullptr ? 0 : *read_s), ""};
}
Value whole_cells_per_second(const Row& row) { return quotient(cells(row), whole_seconds(row)); }

// From the finished surface to the mesh. Cells that came with the surface are not counted.
Value volume_seconds(const Row& row) {
  const double* const surface_s = row.mesh ? row.mesh->phases_s.find("surface") : nullptr;
  if (surface_s == nullptr) return absent("rows have no phases_s/surface");
  return {*whole_seconds(row).number - *surface_s, ""};
}
Value volume_cells_per_second(const Row& row) {
  if (!row.mesh) return absent("rows have no cells");
  const auto num_before = static_cast<double>(row.mesh->surface_cells.value_or(0));
  return quotient({static_cast<double>(row.mesh->cells) - num_before, ""}, volume_seconds(row));
}

Value cells_per_second(const Row& row) { return quotient(cells(row), seconds(row)); }
Value cells_per_second_and_core(const Row& row) { return quotient(cells_per_second(row), threads(row)); }
Value refining_cells_per_second(const Row& row) { return quotient(cells(row), refining_seconds(row)); }
Value refining_cells_per_second_and_core(const Row& row) {
  return quotient(refining_cells_per_second(row), threads(row));
}

// Returns the sum over all processes that ran at the same time, or the rate of a single process.
Value side_by_side_refining_cells_per_second(const Row& row) {
  if (!row.side_by_side) return refining_cells_per_second(row);
  double sum = 0;
  for (const CopyRecord& copy : *row.side_by_side) {
    const Value rate = quotient({static_cast<double>(copy.cells), ""}, refining_seconds_of(copy.phases_s));
    if (!rate.number) return rate;
    sum += *rate.number;
  }
  return {sum, ""};
}

constexpr Measure kOfTime[] = {
    {"seconds", "s", kLess, kClock, seconds},
    {"refining_seconds", "s", kLess, kClock, refining_seconds},
    {"whole_seconds", "s", kLess, kClock, whole_seconds},
    {"whole_cells_per_second", "1/s", kMore, kClock, whole_cells_per_second},
    {"volume_seconds", "s", kLess, kClock, volume_seconds},
    {"volume_cells_per_second", "1/s", kMore, kClock, volume_cells_per_second},
    {"cells_per_second", "1/s", kMore, kClock, cells_per_second},
    {"cells_per_second_and_core", "1/s", kMore, kClock, cells_per_second_and_core},
    {"refining_cells_per_second", "1/s", kMore, kClock, refining_cells_per_second},
    {"refining_cells_per_second_and_core", "1/s", kMore, kClock, refining_cells_per_second_and_core},
    {"side_by_side_refining_cells_per_second", "1/s", kMore, kClock, side_by_side_refining_cells_per_second},
};

}  // namespace

std::span<const Measure> measures_of_time() { return kOfTime; }

}  // namespace podm::bench
