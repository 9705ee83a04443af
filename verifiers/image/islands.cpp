#include "image/islands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "image/raw_image.h"

namespace podm::verify {

namespace {

constexpr double kRounding = 1e-6;  // relative, of volumes and areas

double voxel_mm3(const Image& image) {
  const auto& a = image.voxel_to_ras;
  return std::abs(a[0] * (a[5] * a[10] - a[6] * a[9]) - a[1] * (a[4] * a[10] - a[6] * a[8]) +
                  a[2] * (a[4] * a[9] - a[5] * a[8]));
}

// Finds islands: floods from each voxel that no flood has reached yet, and keeps the small sets.
class Islands {
 public:
  Islands(const Image& image, std::uint32_t background, double below_mm3)
      : image_(image), background_(background), is_reached_(image.voxels.size()) {
    const double most_voxels = below_mm3 * (1 - kRounding) / voxel_mm3(image);
    for (std::size_t seed = 0; seed < image.voxels.size(); ++seed) {
      if (is_reached_[seed] || image.voxels[seed] == background) continue;
      const std::vector<std::size_t> set = flood(seed);
      if (static_cast<double>(set.size()) < most_voxels) islands_.push_back(set);
    }
    is_island_.resize(image.voxels.size());
    for (const auto& island : islands_)
      for (const std::size_t at : island) is_island_[at] = true;
  }

  const std::vector<std::vector<std::size_t>>& all() const { return islands_; }

  /// Returns by label the area of faces, mm^2, that the island shares with voxels outside all islands.
  std::map<std::uint32_t, double> shared_mm2(const std::vector<std::size_t>& island) const {
    std::map<std::uint32_t, std::array<std::size_t, 3>> faces;
    for (const std::size_t at : island)
      for_each_neighbour(at, [&](std::size_t other, std::size_t axis) {
        if (other == kOutside) {
          ++faces[background_][axis];
        } else if (!is_island_[other]) {
          ++faces[image_.voxels[other]][axis];
        }
      });
    std::map<std::uint32_t, double> areas;
    for (const auto& [label, n] : faces)
      for (std::size_t axis = 0; axis < 3; ++axis)
        areas[label] +=
            static_cast<double>(n[axis]) * image_.spacing[(axis + 1) % 3] * image_.spacing[(axis + 2) % 3];
    return areas;
  }

 private:
  static constexpr auto kOutside = static_cast<std::size_t>(-1);

  template <class Visit>
  void for_each_neighbour(std::size_t at, const Visit& visit) const {
    std::size_t stride = 1, rest = at;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto size = static_cast<std::size_t>(image_.size[axis]);
      const std::size_t position = rest % size;
      visit(position > 0 ? at - stride : kOutside, axis);
      visit(position + 1 < size ? at + stride : kOutside, axis);
      rest /= size;
      stride *= size;
    }
  }

  std::vector<std::size_t> flood(std::size_t seed) {
    std::vector<std::size_t> set{seed};
    is_reached_[seed] = true;
    for (std::size_t next = 0; next < set.size(); ++next)
      for_each_neighbour(set[next], [&](std::size_t other, std::size_t) {
        if (other == kOutside || is_reached_[other] || image_.voxels[other] != image_.voxels[seed]) return;
        is_reached_[other] = true;
        set.push_back(other);
      });
    return set;
  }

  const Image& image_;
  std::uint32_t background_;
  std::vector<bool> is_reached_, is_island_;
  std::vector<std::vector<std::size_t>> islands_;
};

// Returns the label of the largest area. Among equal areas the background comes first, then the least label,
// as the map is sorted.
std::uint32_t largest(const std::map<std::uint32_t, double>& areas, std::uint32_t background) {
  double most = 0;
  for (const auto& [label, area] : areas) most = std::max(most, area);
  const auto is_largest = [&](double area) { return area >= most * (1 - kRounding); };
  if (const auto own = areas.find(background); own != areas.end() && is_largest(own->second))
    return background;
  return std::find_if(areas.begin(), areas.end(), [&](const auto& of) { return is_largest(of.second); })
      ->first;
}

}  // namespace

void drop_islands(Image& image, std::uint32_t background, double below_mm3) {
  for (bool is_changed = true; is_changed;) {
    const Islands islands(image, background, below_mm3);
    std::vector<std::pair<const std::vector<std::size_t>*, std::uint32_t>> becomes;
    for (const auto& island : islands.all())
      if (const auto areas = islands.shared_mm2(island); !areas.empty())
        becomes.emplace_back(&island, largest(areas, background));
    for (const auto& [island, label] : becomes)
      for (const std::size_t at : *island) image.voxels[at] = label;
    is_changed = !becomes.empty();
  }
  if (std::all_of(image.voxels.begin(), image.voxels.end(), [&](std::uint32_t v) { return v == background; }))
    refuse(image.path, fmt::format("--drop-islands: no label has {:g} mm^3 in one piece", below_mm3));
}

}  // namespace podm::verify
