#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "rows/codec.h"
#include "submissions/checks.h"

namespace podm::bench {
namespace {

// The mesher computes its rates from the same seconds that it records, in another order of additions.
constexpr double kRounding = 1e-6;
// The clocks of the mesher and of podm-bench, and the kernel's counts of processor time, are different
// clocks.
constexpr double kShareBetweenClocks = 0.02, kSecondsBetweenClocks = 0.05;
constexpr std::uint64_t kAnglesPerCell = 6;

bool is_about(double value, double expected) {
  return std::abs(value - expected) <= kRounding * std::abs(expected);
}

bool fits(double seconds, double limit_s) {
  return seconds <= limit_s * (1 + kShareBetweenClocks) + kSecondsBetweenClocks;
}

std::string fault_of_rate(const char* name, double rate, std::uint64_t cells, double seconds) {
  if (seconds <= 0 || is_about(rate * seconds, static_cast<double>(cells))) return "";
  return fmt::format("{} is {:.6g}, but {} cells in {:.6g} s are {:.6g} per second", name, rate, cells,
                     seconds, static_cast<double>(cells) / seconds);
}

std::string fault_of_seconds(const Row& row) {
  double all_s = 0;
  for (const auto& [phase, phase_s] : row.mesh->phases_s) {
    if (!std::isfinite(phase_s) || phase_s < 0) return fmt::format("phase {} takes {} s", phase, phase_s);
    all_s += phase_s;
  }
  const ProcessRecord& process = row.process;
  if (!fits(all_s, process.wall_s))
    return fmt::format("its phases take {:.6g} s, its process {:.6g} s", all_s, process.wall_s);
  const double processors_s = process.wall_s * row.environment.usable_processors;
  if (!fits(process.user_s + process.system_s, processors_s))
    return fmt::format("{:.6g} s of processor time in {:.6g} s of {} processors",
                       process.user_s + process.system_s, process.wall_s, row.environment.usable_processors);
  const MeshRecord& mesh = *row.mesh;
  if (mesh.cells_per_second)
    if (std::string fault = fault_of_rate("cells_per_second", *mesh.cells_per_second, mesh.cells,
                                          meshing_seconds(mesh.phases_s));
        !fault.empty())
      return fault;
  const double* const refine_s = mesh.phases_s.find("refine");
  return refine_s == nullptr
             ? ""
             : fault_of_rate("refine_cells_per_second", mesh.refine_cells_per_second, mesh.cells, *refine_s);
}

// Returns the cells of all labels; nothing without labels.
std::optional<std::uint64_t> cells_of_labels(const Json& row) {
  const Json labels = row.value("labels", Json());
  if (!labels.is_array() || labels.empty()) return {};
  std::uint64_t cells = 0;
  for (const Json& label : labels) {
    const Json own = label.is_object() ? label.value("cells", Json()) : Json();
    if (!own.is_number_unsigned()) return {};
    cells += own.get<std::uint64_t>();
  }
  return cells;
}

std::string fault_of_cells(const MeshRecord& mesh, const Json& row) {
  if (const auto cells = cells_of_labels(row); cells && *cells != mesh.cells)
    return fmt::format("{} cells, but its labels have {}", mesh.cells, *cells);
  if (mesh.dihedral_deg) {
    std::uint64_t angles = 0;
    for (const std::uint64_t count : mesh.dihedral_deg->counts) angles += count;
    if (angles != kAnglesPerCell * mesh.cells)
      return fmt::format("{} cells have {} dihedral angles, not six each", mesh.cells, angles);
  }
  return "";
}

}  // namespace

void check_clock(const Submission& submission, Faults& faults) {
  for (const auto& [row, line, logs] : submission.rows) {
    if (!row.mesh) continue;
    for (const std::string& fault : {fault_of_seconds(row), fault_of_cells(*row.mesh, *line)})
      if (!fault.empty()) faults.push_back({"clock", fmt::format("{}: {}", name_of(row), fault)});
  }
}

}  // namespace podm::bench
