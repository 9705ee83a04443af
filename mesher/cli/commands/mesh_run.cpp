#include "cli/commands/mesh_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/reports/json_text.h"
#include "cli/reports/record.h"
#include "cli/reports/summary.h"

namespace podm::cli {

std::map<std::string, double> MeshRun::phases_s() const {
  std::map<std::string, double> phases = report.phases_s;
  phases[command.image.is_phantom() ? "draw" : "read"] = read_s;
  if (!values.empty()) phases["values"] = values_s;
  if (!command.mesh_path.empty()) phases["write"] = write_s;
  return phases;
}

double MeshRun::cells_per_second() const {
  static const std::set<std::string> kNotCounted{"calibrate", "draw",   "perturb", "optimize",
                                                 "measure",   "values", "write"};
  double seconds = 0;
  for (const auto& [phase, phase_s] : phases_s())
    if (!kNotCounted.contains(phase)) seconds += phase_s;
  return static_cast<double>(mesh.cells) / seconds;
}

double MeshRun::refine_cells_per_second() const {
  const double refine_s = report.phases_s.at("refine");
  return refine_s > 0 ? static_cast<double>(mesh.cells) / refine_s : 0;  // 0: the run ended before refinement
}

void MeshRun::take(MeshingReport&& finished, const TetMesh& made) {
  report = std::move(finished);
  mesh = numbers_of(made);
  report.warnings.insert(report.warnings.end(), image.warnings.begin(), image.warnings.end());
  if (const auto& sizes = options.sizes.image)
    report.warnings.insert(report.warnings.end(), sizes->warnings.begin(), sizes->warnings.end());
}

std::map<std::string, std::string> MeshRun::verdicts() const {
  std::map<std::string, std::string> verdicts;
  if (!verification) return verdicts;
  for (const auto& [claim, result] : verification->at("claims").items())
    verdicts[claim] = result.at("verdict");
  return verdicts;
}

std::vector<std::string> MeshRun::unmet() const {
  std::vector<std::string> sentences;
  const auto count = [&](std::uint64_t misses, const std::string& what) {
    if (misses > 0) sentences.push_back(fmt::format("{}: {}", what, misses));
  };
  const StopReason reason = report.stop_reason;
  if (reason != StopReason::kComplete)
    sentences.push_back(fmt::format("the run ended early: {}", to_string(reason)));
  if (mesh.cells == 0)
    sentences.push_back(command.mesh_path.empty() ? "the mesh has no cell"
                                                  : "the mesh has no cell; no file is written");
  const Guarantees& misses = report.guarantees;
  count(misses.radius_edge, fmt::format("cells with a radius-edge ratio of {} or more", kRadiusEdgeBound));
  count(misses.facet_angle,
        fmt::format("boundary facets with an angle of {} degrees or less", kFacetAngleBound));
  count(misses.radius, "cells with a circumradius above the bound");
  count(misses.facet_vertices, "boundary facets with a vertex off the isosurface");
  count(misses.orientation, "cells that rounding made flat or inverted");
  count(misses.missing_labels, "labels of more than 1000 voxels without a cell");
  count(misses.topology, "components whose topology differs from the image's");
  count(misses.off_sides, "facets that leave the side of the box where they end the object");
  if (command.verify && !verification && mesh.cells > 0)
    sentences.push_back("podm-verify: ended early by a signal; no claim is decided");
  for (const auto& [claim, verdict] : verdicts())
    if (verdict != "pass") sentences.push_back(fmt::format("podm-verify: claim {}: {}", claim, verdict));
  return sentences;
}

namespace {

std::vector<FacetCount> most_first(const std::map<std::array<LabelIndex, 2>, std::uint64_t>& by_pair) {
  std::vector<FacetCount> counts;
  for (const auto& [pair, facets] : by_pair) counts.push_back({pair, facets});
  std::stable_sort(counts.begin(), counts.end(),
                   [](const FacetCount& a, const FacetCount& b) { return a.facets > b.facets; });
  return counts;
}

}  // namespace

std::vector<FacetCount> sums_of(const std::vector<FacetCount>& counts) {
  std::map<std::array<LabelIndex, 2>, std::uint64_t> by_pair;
  for (const FacetCount& count : counts) by_pair[count.labels] += count.facets;
  return most_first(by_pair);
}

MeshNumbers numbers_of(const TetMesh& mesh) {
  std::map<std::array<LabelIndex, 2>, std::uint64_t> by_pair;
  for (const auto& pair : mesh.facet_labels) ++by_pair[pair];
  return {.cells = mesh.cells.size(),
          .vertices = mesh.vertices.size(),
          .boundary_facets = mesh.facets.size(),
          .facet_pairs = most_first(by_pair)};
}

int report(const MeshRun& run, std::optional<AppendedFile>& records) {
  if (records) records->append(json_line(record(run)));
  if (!run.command.quiet) fmt::print(stderr, "{}", summary(run));
  if (run.command.stats) fmt::print(stderr, "{}", statistics(run));
  for (const std::string& warning : run.report.warnings) fmt::print(stderr, "warning: {}\n", warning);
  const auto unmet = run.unmet();
  for (const std::string& sentence : unmet) fmt::print(stderr, "{}: {}\n", run.program, sentence);
  return unmet.empty() ? 0 : 1;
}

}  // namespace podm::cli
