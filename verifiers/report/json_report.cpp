#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "errors.h"
#include "image/image_frame.h"
#include "ranks/part.h"
#include "report/reports.h"
#include "sha256.h"

namespace podm::verify {

namespace {

using Json = nlohmann::json;

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json file_of(const std::string& path) {
  return path.empty() ? Json(nullptr) : Json{{"path", path}, {"sha256", sha256_of(path)}};
}

Json image_of(const Inputs& inputs, const Options& options) {
  Json json = file_of(options.image_path);
  if (inputs.image && !inputs.image->warnings.empty()) json["warnings"] = inputs.image->warnings;
  if (inputs.image && inputs.image->smoothing) json["smoothed_mm"] = inputs.image->smoothing->width_mm;
  return json;
}

Json size_image_of(const Inputs& inputs, const Options& options) {
  Json json = file_of(options.size_image_path);
  if (inputs.sizes && !inputs.sizes->warnings.empty()) json["warnings"] = inputs.sizes->warnings;
  return json;
}

Json size_near_of(const Options& options) {
  Json json = Json::array();
  for (const InterfaceSize& near : options.interface_sizes)
    json.push_back({{"labels", near.labels}, {"radius_mm", near.radius_mm}, {"width_mm", near.width_mm}});
  return json;
}

Json witness_of(const Witness& witness) {
  Json points = Json::array();
  for (const Point& p : witness.points) points.push_back({finite(p[0]), finite(p[1]), finite(p[2])});
  return {{"statement", witness.statement}, {"cells", witness.cells},
          {"vertices", witness.vertices},   {"points", points},
          {"value", finite(witness.value)}, {"label", witness.label}};
}

Json histogram_of(const Histogram& histogram) {
  return {{"name", histogram.name},
          {"unit", histogram.unit},
          {"low", histogram.low},
          {"high", histogram.high},
          {"minimum", finite(histogram.minimum)},
          {"maximum", finite(histogram.maximum)},
          {"counts", histogram.counts}};
}

Json claim_of(const ClaimResult& result) {
  Json worst = Json::array(), histograms = Json::array();
  for (const Witness& witness : result.worst) worst.push_back(witness_of(witness));
  for (const Histogram& histogram : result.histograms) histograms.push_back(histogram_of(histogram));
  return {{"verdict", to_string(result.verdict)},
          {"reason", result.reason},
          {"method", result.method},
          {"num_checked", result.num_checked},
          {"num_exact", result.num_exact},
          {"num_violations", result.num_violations},
          {"num_warnings", result.num_warnings},
          {"worst", worst},
          {"histograms", histograms},
          {"details", result.details()},
          {"seconds", result.seconds}};
}

Json selection_of(const LabelSelection& selection) {
  return {{"background", selection.background},
          {"labels", selection.keep},
          {"drop", selection.drop},
          {"merge", selection.merges},
          {"layers", selection.layers},
          {"drop_islands_mm3", selection.drop_islands_mm3}};
}

Json options_of(const Options& options) {
  Json radius_of = Json::object();
  for (const auto& [label, radius] : options.radius_of) radius_of[std::to_string(label)] = radius;
  return {{"claims", options.claims.empty() ? Json(nullptr) : Json(options.claims)},
          {"space", options.space ? Json(describe(*options.space)) : Json(nullptr)},
          {"selection", selection_of(options.selection)},
          {"box", options.is_box_flat ? Json(*options.is_box_flat ? "flat" : "open") : Json(nullptr)},
          {"smooth_mm", options.smooth_mm ? Json(*options.smooth_mm) : Json(nullptr)},
          {"radius_edge_bound", options.radius_edge_bound},
          {"angle_bound_deg", options.angle_bound_deg},
          {"radius_mm", options.radius_mm ? Json(*options.radius_mm) : Json(nullptr)},
          {"radius_of_mm", radius_of},
          {"size_factor", options.size_factor},
          {"size_near", size_near_of(options)},
          {"grade", options.grade ? Json(*options.grade) : Json(nullptr)},
          {"min_dihedral_deg", options.min_dihedral_deg ? Json(*options.min_dihedral_deg) : Json(nullptr)},
          {"max_dihedral_deg", options.max_dihedral_deg ? Json(*options.max_dihedral_deg) : Json(nullptr)},
          {"fidelity_bound_voxels", options.fidelity_bound_voxels},
          {"vertex_bound_voxels", options.vertex_bound_voxels},
          {"delta_mm", options.delta_mm ? Json(*options.delta_mm) : Json(nullptr)},
          {"lines_delta_mm", options.lines_delta_mm ? Json(*options.lines_delta_mm) : Json(nullptr)},
          {"threads", options.threads}};
}

}  // namespace

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string json_report(const Inputs& inputs, const Options& options, const std::vector<ClaimResult>& results,
                        double seconds, std::uint64_t peak_bytes) {
  const Mesh& mesh = inputs.mesh;
  Json claims = Json::object();
  for (const ClaimResult& result : results) claims[result.claim] = claim_of(result);
  Json mesh_json = file_of(mesh.path);
  mesh_json["format"] = mesh.format;
  mesh_json["cells"] = num_cells(mesh);
  mesh_json["vertices"] = num_vertices(mesh);
  mesh_json["space"] = describe(mesh.space);
  mesh_json["cell_label_array"] = mesh.cell_label_array;
  mesh_json["other_cells"] = mesh.other_cells;
  mesh_json["unclaimed"] = mesh.unclaimed;
  mesh_json["promised_dihedral_deg"] =
      mesh.promised_dihedral_deg ? Json(*mesh.promised_dihedral_deg) : Json(nullptr);
  mesh_json["promised_lines_delta_mm"] =
      mesh.promised_lines_delta_mm ? Json(*mesh.promised_lines_delta_mm) : Json(nullptr);
  mesh_json["promises_flat_box"] = mesh.promises_flat_box;
  mesh_json["smoothing_mm"] = mesh.smoothing_mm ? Json(*mesh.smoothing_mm) : Json(nullptr);
  const Json report{{"schema", "podm-verify/1"},
                    {"program", "podm-verify " PODM_VERSION},
                    {"mesh", mesh_json},
                    {"image", image_of(inputs, options)},
                    {"schedule", file_of(options.schedule_path)},
                    {"size_image", size_image_of(inputs, options)},
                    {"options", options_of(options)},
                    {"claims", claims},
                    {"ranks", ranks_of(mesh).size()},
                    {"seconds", seconds},
                    {"peak_rss_bytes", peak_bytes}};
  return report.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace podm::verify
