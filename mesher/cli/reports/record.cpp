#include "cli/reports/record.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands/verify_mesh.h"
#include "cli/options/options_json.h"
#include "cli/reports/input_sha256.h"
#include "cli/reports/json_text.h"
#include "io/sha256.h"

namespace podm {

PODM_TO_JSON(LabelSelection::Merge, values, name)
PODM_TO_JSON(InterfaceSize, labels, radius_mm, width_mm)
PODM_TO_JSON(PageSamples::OfArray, as_claimed, elsewhere, untouched)
PODM_TO_JSON(Calibration::TrialMesh, radius_mm, cells, seconds)
PODM_TO_JSON(Calibration, target_elements, radius_mm, meshes, seconds)
PODM_TO_JSON(PerturbationReport::Cells, with_free_vertex, without)
PODM_TO_JSON(SmoothingReport::OfLabel, value, voxels_mm3, smoothed_mm3, voxels_components,
             smoothed_components, is_thin)
PODM_TO_JSON(SmoothingReport, width_mm, labels)
PODM_TO_JSON(Quality, max_radius_edge, min_facet_angle_deg, max_facet_angle_deg, min_dihedral_deg,
             max_dihedral_deg, max_radius_mm, shortest_edge_mm)
PODM_TO_JSON(Guarantees, radius_edge, facet_angle, radius, facet_vertices, orientation, missing_labels,
             topology, off_sides)

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

Json selection_of(const LabelSelection& selection) {
  return {{"background", selection.background},
          {"keep", selection.keep},
          {"drop", selection.drop},
          {"merge", selection.merges},
          {"layers", selection.layers},
          {"drop_islands_mm3", selection.drop_islands_mm3}};
}

Json dropped_islands_of(const LabelImage& image) {
  Json dropped = Json::array();
  for (const DroppedIslands& of : image.dropped_islands)
    dropped.push_back({{"value", of.label.value},
                       {"name", of.label.name},
                       {"islands", of.number},
                       {"volume_mm3", of.volume_mm3},
                       {"is_whole_label", of.is_whole_label}});
  return dropped;
}

// Returns the requested bounds; null if optimisation was not requested.
Json optimize_of(const OptimizeOptions& optimize) {
  if (!optimize.is_wanted) return nullptr;
  return {{"least_dihedral_deg", optimize.dihedral_bounds_deg[0]},
          {"largest_dihedral_deg", optimize.dihedral_bounds_deg[1]}};
}

Json size_image_of(const MeshRun& run) {
  const std::string& path = run.command.size_image_path;
  if (path.empty()) return nullptr;
  return {{"path", path}, {"sha256", file_sha256(path)}};
}

Json values_of(const MeshRun& run) {
  Json all = Json::array();
  for (const ValuesOnCells& values : run.values)
    all.push_back({{"name", values.name},
                   {"path", values.path},
                   {"sha256", file_sha256(values.path)},
                   {"least_mean", values.report.least_mean},
                   {"largest_mean", values.report.largest_mean},
                   {"partly_covered", values.report.partly_covered}});
  return all;
}

// The options as given; 0 means what it means in MeshingOptions. Labels are those of the image.
Json options_of(const MeshRun& run) {
  Json options = option_values(run.command);
  Json& radius_of = options["radius_of_mm"] = Json::object();
  for (const auto& [value, radius_mm] : run.options.sizes.radius_of_mm)
    radius_of[std::to_string(value)] = radius_mm;
  options["size_image"] = size_image_of(run);
  options["size_near"] = run.options.sizes.near;
  options["optimize"] = optimize_of(run.options.optimize);
  options["labels"] = selection_of(run.command.image.selection);
  return options;
}

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

// Returns the place of each worker. Processors have the system's numbers; nodes and sockets are counted from
// 0.
Json placement_of(const MeshingReport& report) {
  Json places = Json::array();
  for (const WorkerReport& worker : report.workers)
    places.push_back({{"processor", or_null(worker.processor)},
                      {"bound_to", or_null(worker.bound_to)},
                      {"node", worker.node},
                      {"socket", worker.socket}});
  return places;
}

Json unavailable(const std::string& why) { return "unavailable: " + why; }

// Returns accesses by kind and distance, or the reason why a machine with one node has none.
Json hops_by_kind(const HopsByKind& hops, const MeshingReport& report) {
  if (hops.mesh_reads.empty()) return unavailable("one NUMA node or one thread");
  Json kinds = {{"mesh_reads", hops.mesh_reads},
                {"mesh_writes", hops.mesh_writes},
                {"image_reads", hops.image_reads},
                {"transform_reads", hops.transform_reads}};
  if (!report.image_reads_unavailable.empty())
    kinds["image_reads"] = kinds["transform_reads"] = unavailable(report.image_reads_unavailable);
  return kinds;
}

// Returns the accesses that Table 2 counts.
Json hops_of(const MeshingReport& report) {
  const Json kinds = hops_by_kind(report.counters.hops, report);
  return kinds.is_object() ? kinds["mesh_reads"] : kinds;
}

Json pages_of(const MeshingReport& report) {
  if (!report.pages.unavailable.empty()) return unavailable(report.pages.unavailable);
  Json phases = Json::object();
  for (const PageSamples::AtPhase& at : report.pages.phases) {
    Json& phase = phases[at.phase];
    for (const PageSamples::OfArray& pages : at.arrays) phase[pages.array] = pages;
    phase["accesses_by_hops"] = at.accesses_by_hops;
  }
  return phases;
}

void add_counts(const Counters& counters, Count::Kind kind, Json& counts) {
  for (const Count& count : kCounts)
    if (count.kind == kind) counts[count.name] = counters.*count.member;
}

Json outcomes_of(const Counters& counters) {
  Json outcomes = {{"committed", counters.num_committed()}};
  add_counts(counters, Count::kOutcome, outcomes);
  return outcomes;
}

Json counters_of(const MeshingReport& report) {
  const Counters& counters = report.counters;
  Json insertions = Json::object();
  constexpr std::array kRules{"R1", "R2", "R3", "R4", "R5", "R0"};
  for (std::size_t rule = 0; rule < kRules.size() - !report.lines; ++rule)
    insertions[kRules[rule]] = counters.insertions_by_rule[rule];
  Json counts = {{"insertions", insertions}};
  add_counts(counters, Count::kWork, counts);
  counts["store_cells"] = report.store_cells;
  return counts;
}

Json seconds_of(const Overhead& overhead, const std::string& suffix = "") {
  Json seconds = Json::object();
  for (const Cause& cause : kCauses) seconds[cause.name + suffix] = overhead.*cause.member;
  return seconds;
}

Json workers_of(const MeshingReport& report) {
  Json workers = Json::array();
  for (const WorkerReport& worker : report.workers) {
    const Counters& counters = worker.counters;
    Json of_worker = {{"committed", counters.num_committed()}};
    for (const Count& count : kCounts)
      if (count.by_worker) of_worker[count.name] = counters.*count.member;
    of_worker.update(seconds_of(counters.overhead, "_s"));
    of_worker["hops_by_kind"] = hops_by_kind(counters.hops, report);
    workers.push_back(std::move(of_worker));
  }
  return workers;
}

Json simulated_machine_of(const MeshRun& run) {
  const auto& machine = run.report.simulated_machine;
  if (!machine) return nullptr;
  const std::string& path = run.options.team.topology_path;
  return {{"name", machine->name},
          {"path", path},
          {"sha256", file_sha256(path)},
          {"constants", machine->constants}};
}

std::string text_sha256(std::string_view text) {
  Sha256 digest;
  digest.update(std::span(text));
  return digest.hexadecimal();
}

// Times of a virtual executor are simulated, so they are stored apart from measured times.
Json virtual_of(const MeshRun& run) {
  if (run.report.virtual_model.empty()) return nullptr;
  double refine_s = 0;
  const std::map<std::string, double>& phases_s = run.report.virtual_phases_s;
  for (const char* phase : {"initial", "refine", "closing"})
    if (const auto found = phases_s.find(phase); found != phases_s.end()) refine_s += found->second;
  return {{"cost", to_string(run.options.team.virtual_cost)},
          {"refine_s", refine_s},
          {"phases_s", phases_s},
          {"worker_s", run.report.virtual_worker_s},
          {"model_sha256", text_sha256(run.report.virtual_model)},
          {"machine", simulated_machine_of(run)}};
}

// Returns null if R7 was not requested, or the run ended before it.
Json perturbation_of(const MeshingReport& report) {
  if (!report.perturbation) return nullptr;
  const PerturbationReport& perturbation = *report.perturbation;
  Json unmoved = {{"not_reached", perturbation.not_reached}};
  for (const auto& [why, name] : Names<Unmoved>::kAll)
    unmoved[name] = perturbation.unmoved[static_cast<std::size_t>(why)];
  return {{"min_dihedral_deg", perturbation.min_dihedral_deg},
          {"max_dihedral_deg", perturbation.max_dihedral_deg},
          {"before", perturbation.before},
          {"after", perturbation.after},
          {"unmoved", unmoved}};
}

template <class Choice>
Json counts_of(const std::map<Choice, std::uint64_t>& counts) {
  Json json = Json::object();
  for (const auto& [choice, name] : Names<Choice>::kAll) {
    const auto found = counts.find(choice);
    json[name] = found == counts.end() ? 0 : found->second;
  }
  return json;
}

Json optimization_of(const MeshingReport& report) {
  if (!report.optimization) return nullptr;
  const OptimizationReport& done = *report.optimization;
  return {{"least_aim_deg", done.least_aim_deg},
          {"largest_aim_deg", done.largest_aim_deg},
          {"beyond_aim_before", done.beyond_aim_before},
          {"beyond_aim", done.beyond_aim},
          {"beyond_bounds_before", done.beyond_bounds_before},
          {"beyond_bounds", done.beyond_bounds},
          {"obstacles", counts_of(done.obstacles)},
          {"successes", counts_of(done.successes)}};
}

Json thin_layers_of(const MeshingReport& report) {
  if (!report.topology) return nullptr;
  const TopologyReport& of = *report.topology;
  Json differences = Json::array();
  for (const TopologyReport::Difference& each : of.differences)
    differences.push_back({{"kind", to_string(each.kind)},
                           {"label", each.label.value},
                           {"name", each.label.name},
                           {"voxel", each.voxel},
                           {"ras_mm", each.ras_mm},
                           {"component", {{"low", each.low}, {"high", each.high}}},
                           {"of_image", each.of_image},
                           {"of_mesh", each.of_mesh}});
  return {{"components", of.components},         {"ambiguous_places", of.ambiguous_places},
          {"ambiguous", of.ambiguous},           {"differences_at_first", of.differences_at_first},
          {"differences", differences},          {"passes", of.passes},
          {"least_delta_mm", of.least_delta_mm}, {"thin_voxels", of.thin_voxels}};
}

Json facets_of_sides(const MeshingReport& report) {
  if (!report.facets_of_sides) return nullptr;
  Json counts = Json::object();
  for (std::size_t side = 0; side < kNumSides; ++side)
    counts[kSideNames[side]] = (*report.facets_of_sides)[side];
  return counts;
}

// Null unless a mesh with a flat box is in an oblique frame.
Json turned_of(const MeshingReport& report) {
  if (!report.is_delaunay_when_turned) return nullptr;
  return {{"is_delaunay", *report.is_delaunay_when_turned}, {"mended_cells", report.cells_mended_by_turning}};
}

Json label_values(const std::vector<Label>& labels) {
  Json values = Json::array();
  for (const Label& label : labels) values.push_back(label.value);
  return values;
}

Json lines_of(const MeshingReport& report) {
  if (!report.lines) return nullptr;
  const LinesReport& of = *report.lines;
  Json undecided = Json::array(), left_out = Json::array();
  for (const LinesReport::Undecided& each : of.undecided)
    undecided.push_back({{"reason", each.reason}, {"voxel", each.voxel}, {"ras_mm", each.ras_mm}});
  for (const LinesReport::LeftOut& each : of.left_out)
    left_out.push_back({{"reason", each.reason},
                        {"labels", label_values(each.labels)},
                        {"length_mm", each.length_mm},
                        {"ras_mm", each.ras_mm}});
  return {{"delta_mm", of.delta_mm},
          {"floor_mm", of.floor_mm},
          {"arcs", of.arcs},
          {"nodes", of.nodes},
          {"traced_mm", of.traced_mm},
          {"kept_mm", of.kept_mm},
          {"excluded_mm", of.excluded_mm},
          {"untraced_mm", of.untraced_mm},
          {"share_kept", of.share_kept()},
          {"stray_mm", of.stray_mm},
          {"is_traced", of.is_traced},
          {"is_claimed", of.is_claimed()},
          {"edges", of.edges},
          {"splits", of.splits},
          {"inexact_vertices", of.inexact_vertices},
          {"near_lines",
           {{"cells", of.cells_near},
            {"facets", of.facets_near},
            {"max_radius_edge", or_null(of.max_radius_edge_near)},
            {"min_facet_angle_deg", or_null(of.min_facet_angle_near_deg)},
            {"min_facet_angle_away_deg", or_null(of.min_facet_angle_away_deg)}}},
          {"undecided", undecided},
          {"left_out", left_out}};
}

// The inputs that podm-verify needs to judge the mesh, beside mesh and image; null without a mesh.
Json verify_of(const MeshRun& run) {
  if (run.mesh.cells == 0) return nullptr;
  const Judging judging = judging_of(run);
  return {{"claims", judging.claims}, {"options", judging.options}};
}

// Returns the claims of podm-verify that an optimised mesh keeps.
Json promises_of(const MeshingReport& report) {
  Json claims = {"structure", "radius_edge", "boundary_angles",  "size",    "conformity",
                 "surface",   "labels",      "surface_vertices", "fidelity"};
  if (report.promised_dihedral_deg) claims.push_back("dihedral");
  if (report.topology) claims.push_back("topology");
  if (report.facets_of_sides) claims.push_back("box");
  if (report.lines && report.lines->is_claimed()) claims.push_back("lines");
  return claims;
}

Json leaves_of(const MeshRun& run) {
  const Algorithm algorithm = run.report.algorithm;
  if (algorithm == Algorithm::kPodm || algorithm == Algorithm::kPodmHome) return nullptr;
  return {{"number", run.report.num_leaves},
          {"nodes", run.report.computing_nodes},
          {"initial_ratio", run.options.leaves.initial_ratio},
          {"initial_threads", run.options.team.initial_threads},
          {"leaf_size_mm", run.options.leaves.size_mm}};
}

Json labels_of(const MeshRun& run) {
  const MeshingReport& report = run.report;
  Json labels = Json::array();
  for (const Label& label : run.image.labels) {
    const auto cells = report.cells_of_label.find(label.value);
    const auto volume = report.volume_of_label_mm3.find(label.value);
    if (cells == report.cells_of_label.end() || volume == report.volume_of_label_mm3.end()) continue;
    labels.push_back({{"value", label.value},
                      {"name", label.name},
                      {"cells", cells->second},
                      {"volume_mm3", volume->second}});
  }
  return labels;
}

Json facet_pairs_of(const MeshRun& run) {
  const std::vector<Label>& labels = run.image.labels;
  Json pairs = Json::array();
  for (const FacetCount& count : run.mesh.facet_pairs)
    pairs.push_back({{"labels", {labels[count.labels[0]].value, labels[count.labels[1]].value}},
                     {"facets", count.facets}});
  return pairs;
}

}  // namespace

Json record(const MeshRun& run) {
  const MeshingReport& report = run.report;
  const ImageArguments& input = run.command.image;
  Json record = {
      {"schema", kRecordSchema},
      {"program", run.program + " " PODM_VERSION},
      {"algorithm", to_string(report.algorithm)},
      {"input",
       {{"path", input.path},
        {"sha256", input_sha256(input, run.image)},
        {"affine", affine_rows(run.image)}}},
      {"options", options_of(run)},
      {"dropped_islands", dropped_islands_of(run.image)},
      {"used",
       {{"radius_mm", report.radius_mm},
        {"size_image_factor", report.size_image_factor},
        {"delta_mm", report.delta_mm}}},
      {"seed", run.options.team.seed},
      {"threads",
       {{"asked", run.options.team.threads},
        {"used", report.workers.size()},
        {"pin", run.options.team.pin},
        {"placement", placement_of(report)},
        {"contention", to_string(run.options.team.contention)},
        {"begging", to_string(run.options.team.begging)}}},
      {"leaves", leaves_of(run)},
      {"ranks", run.ranks ? *run.ranks : Json()},
      {"executor", to_string(run.options.team.executor)},
      {"virtual", virtual_of(run)},
      {"verify", verify_of(run)},
      {"phases_s", run.phases_s()},
      {"calibration", or_null(report.calibration)},
      {"cells", run.mesh.cells},
      {"vertices", run.mesh.vertices},
      {"boundary_facets", run.mesh.boundary_facets},
      {"labels", labels_of(run)},
      {"facet_pairs", facet_pairs_of(run)},
      {"facets_of_sides", facets_of_sides(report)},
      {"turned", turned_of(report)},
      {"cells_per_second", run.cells_per_second()},
      {"refine_cells_per_second", run.refine_cells_per_second()},
      {"peak_rss_bytes", run.peak_rss_bytes},
      {"outcomes", outcomes_of(report.counters)},
      {"overhead_s", seconds_of(report.counters.overhead)},
      {"hops", hops_of(report)},
      {"hops_by_kind", hops_by_kind(report.counters.hops, report)},
      {"pages", pages_of(report)},
      {"counters", counters_of(report)},
      {"workers", workers_of(report)},
      {"quality", report.quality},
      {"perturbed", perturbation_of(report)},
      {"smoothing", or_null(report.smoothing)},
      {"optimization", optimization_of(report)},
      {"thin_layers", thin_layers_of(report)},
      {"lines", lines_of(report)},
      {"promised_dihedral_deg", or_null(report.promised_dihedral_deg)},
      {"guarantees", report.guarantees},
      {"mesh_sha256", run.mesh_sha256.empty() ? Json() : Json(run.mesh_sha256)},
      {"verdicts", run.verdicts()},
      {"stop_reason", to_string(report.stop_reason)},
      {"warnings", report.warnings},
  };
  if (!run.values.empty()) record["values"] = values_of(run);
  if (report.optimization) record["promises"] = promises_of(report);  // other meshes promise all claims
  return record;
}

}  // namespace cli
}  // namespace podm
