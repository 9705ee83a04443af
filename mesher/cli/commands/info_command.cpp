// podm info: prints the properties of an image and the volume of each label.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "algorithms/team_size.h"
#include "cli/commands/commands.h"
#include "cli/commands/labelled_image.h"
#include "cli/processes/signal_thread.h"
#include "cli/reports/json_text.h"
#include "cli/reports/plan.h"
#include "cli/reports/standard_output.h"
#include "image/foreground.h"
#include "podm/image_io.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;

// The mesher would mesh the whole of such an image, which its maker rarely wants.
std::string note_on_background(const LabelImage& image, const std::vector<std::uint64_t>& counts) {
  if (counts[kBackground] > 0) return "";
  return fmt::format(
      "note       no background: no voxel has the value {}, so the whole image is foreground\n"
      "           (--background VALUE selects another value)\n",
      image.labels[kBackground].value);
}

std::string hexadecimal(const Rgb& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

// Colours have a column only if there are some.
std::string labels_text(const LabelImage& image, const std::vector<std::uint64_t>& counts) {
  const double voxel_mm3 = voxel_volume_mm3(image);
  const bool has_colours = std::any_of(image.labels.begin(), image.labels.end(),
                                       [](const Label& label) { return label.colour.has_value(); });
  const auto colour_column = [&](const std::string& text) {
    return has_colours ? fmt::format("  {:<7}", text) : "";
  };
  std::string text = fmt::format("labels     {}\n{:>10} {:>12} {:>16}{}  {}\n", image.labels.size() - 1,
                                 "value", "voxels", "volume mm^3", colour_column("colour"), "name");
  for (std::size_t i = 0; i < image.labels.size(); ++i) {
    const Label& label = image.labels[i];
    text += fmt::format("{:>10} {:>12} {:>16.6g}{}  {}\n", label.value, counts[i],
                        static_cast<double>(counts[i]) * voxel_mm3,
                        colour_column(label.colour ? hexadecimal(*label.colour) : ""),
                        i == kBackground ? "background" : label.name);
  }
  return text;
}

// The segments of several layers, which overlap.
std::string segments_text(const LabelImage& image) {
  const std::vector<Segment>& segments = image.segments;
  if (std::all_of(segments.begin(), segments.end(), [](const Segment& of) { return of.layer == 0; }))
    return "";
  std::string text = fmt::format("segments   {}\n{:>10} {:>12} {:>16}  {:<7}  {}\n", segments.size(), "label",
                                 "voxels", "covered voxels", "layer", "name");
  for (const Segment& segment : segments)
    text += fmt::format("{:>10} {:>12} {:>16}  {:<7}  {}\n", segment.label.value, segment.voxels,
                        segment.covered, segment.layer, segment.label.name);
  return text;
}

Json segments_json(const LabelImage& image) {
  Json segments = Json::array();
  for (const Segment& segment : image.segments)
    segments.push_back({{"label", segment.label.value},
                        {"name", segment.label.name},
                        {"layer", segment.layer},
                        {"stored_value", segment.stored_value},
                        {"voxels", segment.voxels},
                        {"covered_voxels", segment.covered}});
  return segments;
}

std::string as_text(const std::string& path, const LabelImage& image, const std::optional<Plan>& plan) {
  const auto& affine = image.voxel_to_ras;
  const auto counts = count_voxels(image, 0);
  std::string text = fmt::format(
      "image      {}\n"
      "size       {} x {} x {} voxels\n"
      "spacing    {} x {} x {} mm\n",
      path, image.size[0], image.size[1], image.size[2], image.spacing[0], image.spacing[1],
      image.spacing[2]);
  for (std::size_t row = 0; row < 3; ++row)
    text += fmt::format("{:<11}{:>12.6g} {:>12.6g} {:>12.6g} {:>12.6g}\n", row == 0 ? "affine" : "",
                        affine[4 * row], affine[4 * row + 1], affine[4 * row + 2], affine[4 * row + 3]);
  text += labels_text(image, counts) + segments_text(image);
  return text + note_on_background(image, counts) + (plan ? plan_text(*plan, image) : "");
}

Json as_json(const std::string& path, const LabelImage& image, const std::optional<Plan>& plan) {
  const double voxel_mm3 = voxel_volume_mm3(image);
  const auto counts = count_voxels(image, 0);
  Json labels = Json::array();
  for (std::size_t i = 1; i < image.labels.size(); ++i)
    labels.push_back(
        {{"value", image.labels[i].value},
         {"name", image.labels[i].name},
         {"colour", image.labels[i].colour ? Json(hexadecimal(*image.labels[i].colour)) : Json()},
         {"voxels", counts[i]},
         {"volume_mm3", static_cast<double>(counts[i]) * voxel_mm3}});
  Json info = {{"path", path},
               {"size", image.size},
               {"spacing_mm", image.spacing},
               {"affine", affine_rows(image)},
               {"voxel_volume_mm3", voxel_mm3},
               {"background", {{"value", image.labels[kBackground].value}, {"voxels", counts[kBackground]}}},
               {"labels", labels},
               {"segments", segments_json(image)},
               {"warnings", image.warnings}};
  if (plan) info["plan"] = plan_json(*plan, image);
  return info;
}

}  // namespace

int run(const InfoCommand& command) {
  const SignalThread signals;  // leaves no partial image behind
  const int threads = loop_threads(command.planned.meshing.team);
  const WorkTimer timer(threads);
  const LabelImage image = read_labelled_image(command.image, threads);
  const double read_s = timer.seconds();
  for (const std::string& warning : image.warnings) fmt::print(stderr, "warning: {}\n", warning);
  if (!command.output_path.empty()) write_nifti(image, command.output_path);
  std::optional<Plan> plan;
  if (command.plan) {
    MeshCommand planned = command.planned;
    planned.image = command.image;
    plan = make_plan(planned, image, read_s);
  }
  write_standard_output(command.json ? json_line(as_json(command.image.path, image, plan))
                                     : as_text(command.image.path, image, plan));
  return 0;
}

}  // namespace podm::cli
