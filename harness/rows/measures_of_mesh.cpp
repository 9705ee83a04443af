// The mesh: its size, its faults, what is proved of it, and the outcome of its trial.
#include "rows/measure_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace podm::bench {
namespace {

Value boundary_facets(const Row& row) {
  return number_or_reason(row.mesh ? row.mesh->boundary_facets : std::nullopt, "boundary_facets");
}

Value guarantee_misses(const Row& row) {
  return row.mesh ? sum_of(row.mesh->guarantees) : absent("rows have no guarantees");
}

const ByName<Proof>* verdicts_of(const Row& row) {
  return row.mesh && row.mesh->verdicts ? &*row.mesh->verdicts : nullptr;
}

// not_run never counts as pass.
Value unproved_claims(const Row& row) {
  const auto* const verdicts = verdicts_of(row);
  if (verdicts == nullptr || verdicts->empty()) return absent("podm-verify did not run");
  return {
      static_cast<double>(std::count_if(verdicts->begin(), verdicts->end(),
                                        [](const auto& verdict) { return verdict.second != Proof::kPass; })),
      ""};
}

Value yes(bool is_so) { return {is_so ? 1.0 : 0.0, ""}; }

Value proved(const Row& row, const std::string& claim) {
  const auto* const verdicts = verdicts_of(row);
  const Proof* const verdict = verdicts == nullptr ? nullptr : verdicts->find(claim);
  return verdict == nullptr ? absent(fmt::format("podm-verify was not asked for {}", claim))
                            : yes(*verdict == Proof::kPass);
}
Value conformity_proved(const Row& row) { return proved(row, "conformity"); }
Value fidelity_proved(const Row& row) { return proved(row, "fidelity"); }
Value dihedral_proved(const Row& row) { return proved(row, "dihedral"); }
Value radius_edge_proved(const Row& row) { return proved(row, "radius_edge"); }
Value boundary_angles_proved(const Row& row) { return proved(row, "boundary_angles"); }
Value lines_proved(const Row& row) { return proved(row, "lines"); }
Value box_proved(const Row& row) { return proved(row, "box"); }
Value topology_proved(const Row& row) { return proved(row, "topology"); }

Value lines_share_kept(const Row& row) {
  if (!row.mesh || !row.mesh->lines) return absent("rows have no lines");
  return {row.mesh->lines->share_kept, ""};
}

// The smaller of the shares of both ways.
Value lines_share_near(const Row& row) {
  if (!row.mesh || !row.mesh->line_distances) return absent("rows have no line_distances");
  const LineDistancesRecord& lines = *row.mesh->line_distances;
  return {std::min(lines.image_to_mesh.share_near, lines.mesh_to_image.share_near), ""};
}
Value lines_share_found(const Row& row) {
  if (!row.mesh || !row.mesh->line_distances) return absent("rows have no line_distances");
  return {row.mesh->line_distances->image_to_mesh.share_near, ""};
}

Value box_ulps_off(const Row& row) {
  return number_or_reason(row.mesh ? row.mesh->box_ulps_off : std::nullopt, "box_ulps_off");
}
Value interface_distance_mm(const Row& row) {
  return number_or_reason(row.mesh ? row.mesh->interface_distance_mm : std::nullopt, "interface_distance_mm");
}

Value topology_differences(const Row& row) {
  if (!row.mesh || !row.mesh->thin_layers) return absent("rows have no thin_layers");
  return {static_cast<double>(row.mesh->thin_layers->differences.size()), ""};
}

Value topology_as_image(const Row& row) {
  if (!row.mesh || !row.mesh->topology) return absent("rows have no topology");
  const TopologyRecord& topology = *row.mesh->topology;
  return yes(topology.components_as_image == topology.labels && topology.euler_as_image == topology.labels);
}

template <SystemRecord SolveRecord::*system, IterationsRecord SystemRecord::*preconditioner>
Value iterations(const Row& row) {
  if (!row.solve) return absent("rows have no solve");
  return {static_cast<double>(((*row.solve).*system.*preconditioner).iterations), ""};
}

// Returns the seconds of the stages that remove slivers.
Value dihedral_seconds(const Row& row) {
  double sum = 0;
  bool is_any = false;
  for (const char* phase : {"perturb", "optimize"}) {
    const double* phase_s = row.mesh ? row.mesh->phases_s.find(phase) : nullptr;
    if (phase_s == nullptr) continue;
    sum += *phase_s;
    is_any = true;
  }
  return is_any ? Value{sum, ""} : absent("rows have neither phases_s/perturb nor phases_s/optimize");
}
Value dihedral_cells_per_second(const Row& row) { return quotient(cells(row), dihedral_seconds(row)); }

const PerturbedRecord* perturbed_of(const Row& row) {
  return row.mesh && row.mesh->perturbed ? &*row.mesh->perturbed : nullptr;
}
Value poor_share_left(const Row& row) {
  const auto* const perturbed = perturbed_of(row);
  if (perturbed == nullptr) return absent("rows have no perturbed");
  return quotient({static_cast<double>(perturbed->after.with_free_vertex), ""},
                  {static_cast<double>(perturbed->before.with_free_vertex), ""});
}

Value beyond_bounds_per_million(const Row& row) {
  if (!row.mesh || !row.mesh->optimization) return absent("rows have no optimization");
  return quotient({1e6 * static_cast<double>(row.mesh->optimization->beyond_bounds), ""}, cells(row));
}

Value replay_equal(const Row& row) {
  return row.replay ? yes(row.replay->end == Replay::End::kEqual) : absent("no replay was asked for");
}

Value has_ended(const Row& row) { return yes(is_finished(row)); }
Value has_passed(const Row& row) { return yes(row.status == Status::kOk); }

constexpr Measure kOfMesh[] = {
    {"cells", "", kMore, kCount, cells},
    {"boundary_facets", "", kMore, kCount, boundary_facets},
    {"guarantee_misses", "", kLess, kFaults, guarantee_misses},
    {"unproved_claims", "", kLess, kFaults, unproved_claims},
    {"poisson_jacobi_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::poisson, &SystemRecord::jacobi>},
    {"poisson_amg_iterations", "", kLess, kFaults, iterations<&SolveRecord::poisson, &SystemRecord::amg>},
    {"elasticity_jacobi_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::elasticity, &SystemRecord::jacobi>},
    {"elasticity_amg_iterations", "", kLess, kFaults,
     iterations<&SolveRecord::elasticity, &SystemRecord::amg>},
    {"dihedral_seconds", "s", kLess, kClock, dihedral_seconds},
    {"dihedral_cells_per_second", "1/s", kMore, kClock, dihedral_cells_per_second},
    {"poor_share_left", "", kLess, kFaults, poor_share_left},
    {"beyond_bounds_per_million", "", kLess, kFaults, beyond_bounds_per_million},
    {"conformity_proved", "", kMore, kAnswer, conformity_proved},
    {"fidelity_proved", "", kMore, kAnswer, fidelity_proved},
    {"dihedral_proved", "", kMore, kAnswer, dihedral_proved},
    {"radius_edge_proved", "", kMore, kAnswer, radius_edge_proved},
    {"boundary_angles_proved", "", kMore, kAnswer, boundary_angles_proved},
    {"lines_proved", "", kMore, kAnswer, lines_proved},
    {"box_proved", "", kMore, kAnswer, box_proved},
    {"topology_proved", "", kMore, kAnswer, topology_proved},
    {"lines_share_kept", "", kMore, kFaults, lines_share_kept},
    {"lines_share_near", "", kMore, kFaults, lines_share_near},
    {"lines_share_found", "", kMore, kFaults, lines_share_found},
    {"box_ulps_off", "ulp", kLess, kFaults, box_ulps_off},
    {"interface_distance_mm", "mm", kLess, kFaults, interface_distance_mm},
    {"topology_differences", "", kLess, kFaults, topology_differences},
    {"topology_as_image", "", kMore, kAnswer, topology_as_image},
    {"replay_equal", "", kMore, kAnswer, replay_equal},
    {"ended", "", kMore, kOutcome, has_ended},
    {"passed", "", kMore, kOutcome, has_passed},
};

}  // namespace

std::span<const Measure> measures_of_mesh() { return kOfMesh; }

}  // namespace podm::bench
