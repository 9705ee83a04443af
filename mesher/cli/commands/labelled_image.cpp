#include "cli/commands/labelled_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "cli/options/nearest_name.h"
#include "geometry/affine.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

bool is_called(const Label& label, const std::string& name_or_value) {
  return label.name == name_or_value || fmt::format("{}", label.value) == name_or_value;
}

std::vector<std::uint32_t> values_called(const std::string& name_or_value, std::span<const Label> labels,
                                         const std::string& image_path) {
  std::vector<std::uint32_t> values;
  std::vector<std::string> names;
  for (const Label& label : labels) {
    names.push_back(label.name);
    if (is_called(label, name_or_value)) values.push_back(label.value);
  }
  if (values.empty())
    throw InputError(
        fmt::format("{}: no label '{}'{}", image_path, name_or_value, did_you_mean(name_or_value, names)));
  return values;
}

}  // namespace

LabelImage read_labelled_image(const ImageArguments& arguments, int threads, std::uint64_t most_bytes) {
  return read_image(arguments.path, with_table(arguments), threads, most_bytes);
}

LabelSelection with_table(const ImageArguments& arguments) {
  LabelSelection selection = arguments.selection;
  if (!arguments.label_names_path.empty()) selection.table = read_label_table(arguments.label_names_path);
  return selection;
}

std::map<std::uint32_t, double> lengths_by_value(
    const std::vector<std::pair<std::string, double>>& lengths_mm, const LabelImage& image,
    const std::string& image_path) {
  const std::span<const Label> labels = std::span(image.labels).subspan(1);
  std::map<std::uint32_t, double> by_value;
  for (const auto& [name_or_value, length_mm] : lengths_mm)
    for (const std::uint32_t value : values_called(name_or_value, labels, image_path))
      by_value[value] = length_mm;
  return by_value;
}

std::vector<InterfaceSize> near_by_value(const std::vector<NearLabels>& near, const LabelImage& image,
                                         const std::string& image_path) {
  std::vector<InterfaceSize> by_value;
  for (const NearLabels& asked : near)
    by_value.push_back({.labels = {values_called(asked.labels[0], image.labels, image_path),
                                   values_called(asked.labels[1], image.labels, image_path)},
                        .radius_mm = asked.radius_mm,
                        .width_mm = asked.width_mm});
  return by_value;
}

double voxel_volume_mm3(const LabelImage& image) { return std::abs(determinant(image.voxel_to_ras)); }

std::string display_name(const Label& label) {
  return label.name.empty() ? fmt::format("label {}", label.value) : label.name;
}

}  // namespace podm::cli
