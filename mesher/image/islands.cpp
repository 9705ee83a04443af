#include "image/islands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "geometry/affine.h"
#include "image/components.h"
#include "image/raw_image.h"

namespace podm {

namespace {

// Volumes and areas that differ only by rounding are equal.
constexpr double kRounding = 1e-6;

using Faces = std::array<std::uint64_t, 3>;  // across each axis

class Dropping {
 public:
  Dropping(LabelImage& image, double below_mm3)
      : image_(image),
        voxel_mm3_(std::abs(determinant(image.voxel_to_ras))),
        most_voxels_(below_mm3 * (1 - kRounding) / voxel_mm3_),
        dropped_(image.labels.size()) {}

  /// Returns false if no island is left.
  bool drop_round() {
    const Components components(image_);
    const auto is_island = [&](Components::Id c) {
      return components[c].label != kBackground &&
             static_cast<double>(components[c].num_voxels) < most_voxels_;
    };
    std::map<Components::Id, std::map<LabelIndex, Faces>> touched;
    const auto touch = [&](Components::Id island, Components::Id other, unsigned axis, int faces) {
      if (!is_island(island) || (other != Components::kOutside && is_island(other))) return;
      const LabelIndex label = other == Components::kOutside ? kBackground : components[other].label;
      touched[island][label][axis] += static_cast<std::uint64_t>(faces);
    };
    components.for_each_contact([&](Components::Id a, Components::Id b, unsigned axis, int faces) {
      touch(a, b, axis, faces);
      if (b != Components::kOutside) touch(b, a, axis, faces);
    });
    std::map<Components::Id, LabelIndex> becomes;
    for (const auto& [island, neighbours] : touched) {
      becomes[island] = most_touched(neighbours);
      note(components[island]);
    }
    components.for_each_run([&](Components::Id c, const Voxel& v, int length) {
      if (!is_island(c)) return;
      if (const auto found = becomes.find(c); found != becomes.end())
        std::fill_n(&image_.voxels[image_.index(v.i, v.j, v.k)], length, found->second);
    });
    return !becomes.empty();
  }

  const std::vector<DroppedIslands>& dropped() const { return dropped_; }

 private:
  LabelIndex most_touched(const std::map<LabelIndex, Faces>& neighbours) const {
    const auto& s = image_.spacing;
    const auto area_mm2 = [&](const Faces& n) {
      return static_cast<double>(n[0]) * s[1] * s[2] + static_cast<double>(n[1]) * s[2] * s[0] +
             static_cast<double>(n[2]) * s[0] * s[1];
    };
    double largest_mm2 = 0;
    for (const auto& [label, faces] : neighbours) largest_mm2 = std::max(largest_mm2, area_mm2(faces));
    return std::find_if(neighbours.begin(), neighbours.end(),
                        [&](const auto& of) { return area_mm2(of.second) >= largest_mm2 * (1 - kRounding); })
        ->first;
  }

  void note(const Component& island) {
    DroppedIslands& of_label = dropped_[island.label];
    ++of_label.number;
    of_label.volume_mm3 += static_cast<double>(island.num_voxels) * voxel_mm3_;
  }

  LabelImage& image_;
  double voxel_mm3_, most_voxels_;
  std::vector<DroppedIslands> dropped_;  // by label
};

// Removes labels without voxels. The other labels keep their order.
void remove_empty_labels(LabelImage& image, const std::string& path) {
  std::vector<char> has_voxels(image.labels.size());
  for (const LabelIndex label : image.voxels) has_voxels[label] = true;
  has_voxels[kBackground] = true;
  std::vector<LabelIndex> becomes(image.labels.size());
  std::vector<Label> labels;
  for (std::size_t i = 0; i < image.labels.size(); ++i) {
    becomes[i] = static_cast<LabelIndex>(labels.size());
    if (has_voxels[i]) labels.push_back(image.labels[i]);
  }
  if (labels.size() == image.labels.size()) return;
  if (labels.size() == 1) refuse(path, spelled("drop-islands") + ": no label has a component of this volume");
  for (LabelIndex& voxel : image.voxels) voxel = becomes[voxel];
  image.labels = std::move(labels);
}

std::string warning_of(const DroppedIslands& dropped, double below_mm3) {
  const Label& label = dropped.label;
  return fmt::format(
      "label {}{} is dropped entirely, {:g} mm^3: none of its {} components has the {:g} mm^3 of {}",
      label.value, label.name.empty() ? "" : fmt::format(" ({})", label.name), dropped.volume_mm3,
      dropped.number, below_mm3, spelled("drop-islands"));
}

}  // namespace

void drop_islands(LabelImage& image, double below_mm3, const std::string& path) {
  if (!(std::isfinite(below_mm3) && below_mm3 > 0))
    refuse(path, spelled("drop-islands") + ": a positive volume in mm^3 is needed");
  Dropping dropping(image, below_mm3);
  while (dropping.drop_round()) {
  }
  std::vector<Label> before = image.labels;
  remove_empty_labels(image, path);
  for (std::size_t i = 0; i < before.size(); ++i) {
    DroppedIslands of_label = dropping.dropped()[i];
    if (of_label.number == 0) continue;
    of_label.is_whole_label = std::none_of(image.labels.begin() + 1, image.labels.end(),
                                           [&](const Label& left) { return left.value == before[i].value; });
    of_label.label = std::move(before[i]);
    if (of_label.is_whole_label) image.warnings.push_back(warning_of(of_label, below_mm3));
    image.dropped_islands.push_back(std::move(of_label));
  }
}

}  // namespace podm
