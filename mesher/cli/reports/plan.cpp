#include "cli/reports/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "algorithms/team_size.h"
#include "cli/commands/labelled_image.h"
#include "cli/options/options_for_image.h"
#include "cli/processes/process_memory.h"
#include "geometry/affine.h"
#include "image/foreground.h"
#include "isosurface/isosurface.h"
#include "prediction/cost_model.h"
#include "run/report_on_smoothing.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPartsInText = 20;  // JSON holds all parts

// Returns an integer, unless no integer holds the number, as with absurdly small sizes.
Json whole(double number) {
  constexpr double kMostWhole = 9e15;
  return number < kMostWhole ? Json(std::llround(number)) : Json(number);
}

std::array<double, 3> place_mm(const LabelImage& image, const Voxel& v) {
  const Point p = map(image.voxel_to_ras, center(v));
  return {p.x, p.y, p.z};
}

std::vector<std::vector<double>> components_mm3(const LabelImage& image) {
  std::vector<std::vector<double>> volumes(image.labels.size());
  const Components components(image);
  for (Components::Id c = 0; c < components.size(); ++c)
    volumes[components[c].label].push_back(static_cast<double>(components[c].num_voxels) *
                                           voxel_volume_mm3(image));
  for (auto& of_label : volumes) std::sort(of_label.begin(), of_label.end(), std::greater());
  return volumes;
}

}  // namespace

Plan make_plan(const MeshCommand& command, const LabelImage& image, double read_s) {
  const MeshingOptions options = options_as_given(command, image, memory_limit_bytes(command));
  const int threads = loop_threads(options.team);
  Plan plan;
  plan.threads = num_workers(options.team);
  plan.read_s = read_s;
  double others_bytes = 0;
  {
    const WorkTimer timer(threads);
    std::shared_ptr<const VoxelWeights> weights;
    if (options.smoothing_mm > 0) {
      const SmoothInterfaces smoothed = smooth_interfaces(image, options.smoothing_mm, threads);
      report_on_smoothing(image, options.smoothing_mm, smoothed, threads);
      weights = smoothed.weights;
    }
    // The transform phase includes the calls below, too.
    const Isosurface isosurface(image, threads, weights);
    foreground_bounds(image, threads);
    estimate(image, options);
    plan.transform_s = timer.seconds();
    others_bytes = static_cast<double>(resident_bytes());
    plan.memory_bytes = static_cast<double>(peak_resident_bytes());
  }
  plan.cost = predict_cost(image, options);
  plan.memory_bytes = std::max(plan.memory_bytes, others_bytes + plan.cost.mesh_bytes);
  plan.thin_parts = find_thin_parts(image, plan.cost.sizes.delta_mm, threads);
  plan.components_mm3 = components_mm3(image);
  return plan;
}

namespace {

// Null if no layer is thin.
Json thinnest_json(const ThinLayers& layers, const LabelImage& image) {
  if (!layers.thinnest) return nullptr;
  const auto& [label, voxel, thickness_mm] = *layers.thinnest;
  return {{"label", image.labels[label].value},
          {"thickness_mm", thickness_mm},
          {"place_mm", place_mm(image, voxel)},
          {"voxel", {voxel.i, voxel.j, voxel.k}}};
}

}  // namespace

nlohmann::ordered_json plan_json(const Plan& plan, const LabelImage& image) {
  Json labels = Json::array(), thin = Json::array();
  for (std::size_t i = 1; i < image.labels.size(); ++i)
    labels.push_back({{"value", image.labels[i].value},
                      {"name", image.labels[i].name},
                      {"cells", whole(plan.cost.cells_of_label[i])},
                      {"components_mm3", plan.components_mm3[i]}});
  for (const ThinPart& part : plan.thin_parts)
    thin.push_back({{"label", image.labels[part.label].value},
                    {"kind", to_string(part.kind)},
                    {"thickness_mm", part.thickness_mm},
                    {"volume_mm3", static_cast<double>(part.num_voxels) * voxel_volume_mm3(image)},
                    {"place_mm", place_mm(image, part.deepest)},
                    {"voxel", {part.deepest.i, part.deepest.j, part.deepest.k}}});
  Json layers;
  if (plan.cost.layers)
    layers = {{"voxels", plan.cost.layers->num_voxels},
              {"least_delta_mm", plan.cost.layers->deltas.least_mm()},
              {"growth_of_cells", plan.cost.growth_at_layers},
              {"thinnest", thinnest_json(*plan.cost.layers, image)}};
  return {{"radius_mm", plan.cost.sizes.radius_mm},
          {"delta_mm", plan.cost.sizes.delta_mm},
          {"threads", plan.threads},
          {"cells", whole(plan.cost.cells)},
          {"memory_bytes", whole(plan.memory_bytes)},
          {"seconds", plan.seconds()},
          {"phases_s", {{"read", plan.read_s}, {"transform", plan.transform_s}, {"mesh", plan.cost.mesh_s}}},
          {"labels", labels},
          {"thin_parts", thin},
          {"kept_layers", layers}};
}

namespace {

std::string cost_text(const Plan& plan) {
  const SizeOptions& sizes = plan.cost.sizes;
  return fmt::format(
      "plan       radius {}, delta {:.4g} mm, {} thread{}\n"
      "cells      about {:.3g}\n"
      "memory     about {:.3g} GiB\n"
      "seconds    about {:.3g}: read {:.2g}, transform {:.2g}, mesh {:.3g}{}\n",
      sizes.radius_mm > 0 ? fmt::format("{:.4g} mm", sizes.radius_mm) : "unbounded", sizes.delta_mm,
      plan.threads, plan.threads == 1 ? "" : "s", plan.cost.cells, plan.memory_bytes / kBytesPerGib,
      plan.seconds(), plan.read_s, plan.transform_s, plan.cost.mesh_s,
      sizes.target_elements > 0 ? ", and up to twice this to find the radius" : "");
}

// Prints all labels, like the table of podm info above it.
std::string labels_text(const Plan& plan, const LabelImage& image) {
  std::string text = fmt::format("{:>10} {:>12} {:>12} {:>14} {:>14}  name\n", "value", "cells", "components",
                                 "largest mm^3", "others mm^3");
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    const std::vector<double>& volumes = plan.components_mm3[i];
    const double others_mm3 = std::accumulate(volumes.begin() + 1, volumes.end(), 0.0);
    text += fmt::format("{:>10} {:>12.3g} {:>12} {:>14.6g} {:>14.6g}  {}\n", image.labels[i].value,
                        plan.cost.cells_of_label[i], volumes.size(), volumes.front(), others_mm3,
                        image.labels[i].name);
  }
  return text;
}

std::string kept_text(const Plan& plan, const LabelImage& image) {
  if (!plan.cost.layers) return "";
  const ThinLayers& layers = *plan.cost.layers;
  if (!layers.thinnest) return "kept       no layer is thinner than delta can show\n";
  const auto& [label, voxel, thickness_mm] = *layers.thinnest;
  const auto at = place_mm(image, voxel);
  return fmt::format(
      "kept       layers of {} voxels, with deltas down to {:.4g} mm and {:.3g} times the cells; the\n"
      "           thinnest is {:.4g} mm thick: label {} at {:.6g} {:.6g} {:.6g} mm; refinements that mend\n"
      "           the topology add cells\n",
      layers.num_voxels, std::max(layers.deltas.least_mm(), kDeltaOverThickness * thickness_mm),
      plan.cost.growth_at_layers, thickness_mm, image.labels[label].value, at[0], at[1], at[2]);
}

std::string thin_text(const Plan& plan, const LabelImage& image) {
  const auto count = [&](ThinKind kind) {
    return std::count_if(plan.thin_parts.begin(), plan.thin_parts.end(),
                         [&](const ThinPart& part) { return part.kind == kind; });
  };
  std::string text = fmt::format(
      "thin       parts that delta may lose or cut: {} whole components, {} bridges between other parts,\n"
      "           {} details: fins, tips and edges\n",
      count(ThinKind::kWhole), count(ThinKind::kBridge), count(ThinKind::kDetail));
  if (plan.thin_parts.empty()) return text;
  text += fmt::format("{:>10} {:>8} {:>14} {:>14}  {:<30}  name\n", "value", "kind", "thickness mm",
                      "volume mm^3", "at, RAS mm");
  for (std::size_t n = 0; n < std::min(plan.thin_parts.size(), kMostPartsInText); ++n) {
    const ThinPart& part = plan.thin_parts[n];
    const auto at = place_mm(image, part.deepest);
    text +=
        fmt::format("{:>10} {:>8} {:>14.4g} {:>14.6g}  {:<30}  {}\n", image.labels[part.label].value,
                    to_string(part.kind), part.thickness_mm,
                    static_cast<double>(part.num_voxels) * voxel_volume_mm3(image),
                    fmt::format("{:.6g} {:.6g} {:.6g}", at[0], at[1], at[2]), image.labels[part.label].name);
  }
  if (plan.thin_parts.size() > kMostPartsInText)
    text += fmt::format("           ... and {} more (--json has all)\n",
                        plan.thin_parts.size() - kMostPartsInText);
  return text;
}

}  // namespace

std::string plan_text(const Plan& plan, const LabelImage& image) {
  return cost_text(plan) + labels_text(plan, image) + thin_text(plan, image) + kept_text(plan, image);
}

}  // namespace podm::cli
