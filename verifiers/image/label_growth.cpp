#include "image/label_growth.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace podm::verify {

// The summed-area table of the faces of one label: eight corners give the sum over any box.
class LabelGrowth::Table {
 public:
  explicit Table(const LabelGrowth& growth) : growth_(growth) {}

  void fill(const VoxelBox& around, std::uint32_t label) {
    corners_ = {around.first, {around.size[0] + 1, around.size[1] + 1, around.size[2] + 1}};
    sums_.assign(corners_.count(), {});
    for (int k = around.first[2]; k < around.end(2); ++k)
      for (int j = around.first[1]; j < around.end(1); ++j)
        for (int i = around.first[0]; i < around.end(0); ++i)
          if (growth_.label({i, j, k}) == label)
            sums_[corners_.at(i + 1, j + 1, k + 1)] = growth_.faces_of({i, j, k});
    for (std::size_t axis = 0; axis < 3; ++axis) add_up(axis);
  }

  // Returns the sum over a box inside the box given to fill().
  Faces in(const VoxelBox& box) const {
    Faces sum;
    for (int corner = 0; corner < 8; ++corner) {
      const auto at = [&](std::size_t axis) {
        return (corner >> axis & 1) != 0 ? box.end(axis) : box.first[axis];
      };
      const int sign = (corner == 7 || corner == 1 || corner == 2 || corner == 4) ? 1 : -1;
      const Faces& below = sums_[corners_.at(at(0), at(1), at(2))];
      sum.area += sign * below.area;
      sum.lead += sign * below.lead;
    }
    return sum;
  }

 private:
  void add_up(std::size_t axis) {
    std::size_t stride = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(corners_.size[a]);
    const auto length = static_cast<std::size_t>(corners_.size[axis]);
    for (std::size_t at = 0; at < sums_.size(); ++at)
      if (at / stride % length != 0) {
        sums_[at].area += sums_[at - stride].area;
        sums_[at].lead += sums_[at - stride].lead;
      }
  }

  const LabelGrowth& growth_;
  VoxelBox corners_;
  std::vector<Faces> sums_;
};

LabelGrowth::LabelGrowth(const Image& image, const std::vector<std::uint16_t>& voxel_weights, double width_mm,
                         int threads)
    : image_(image), voxel_weights_(voxel_weights), threads_(threads), grid_{{}, image.size} {
  const double shortest = *std::min_element(image.spacing.begin(), image.spacing.end());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach_[axis] = voxels_to_cover(2 * width_mm / image.spacing[axis]);
    area_[axis] = std::max(std::int64_t{1},
                           static_cast<std::int64_t>(std::round(256 * shortest / image.spacing[axis])));
  }
}

std::uint32_t LabelGrowth::label(const Voxel& v) const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (v[axis] < 0 || v[axis] >= image_.size[axis]) return 0;
  return image_.voxels[grid_.at(v[0], v[1], v[2])];
}

bool LabelGrowth::is_uniform(const VoxelBox& box) const {
  const std::uint32_t first = label(box.first);
  for (int k = box.first[2]; k < box.end(2); ++k)
    for (int j = box.first[1]; j < box.end(1); ++j)
      for (int i = box.first[0]; i < box.end(0); ++i)
        if (label({i, j, k}) != first) return false;
  return true;
}

bool LabelGrowth::is_at_interface(const Voxel& v) const {
  return !is_uniform(VoxelBox{v, {1, 1, 1}}.grown({1, 1, 1}));
}

// Returns the tile's voxels with another label among their neighbours, grouped by their own label.
std::map<std::uint32_t, std::vector<LabelGrowth::Voxel>> LabelGrowth::at_interfaces(
    const VoxelBox& tile) const {
  std::map<std::uint32_t, std::vector<Voxel>> found;
  if (is_uniform(tile.grown({1, 1, 1}))) return found;
  for (int k = tile.first[2]; k < tile.end(2); ++k)
    for (int j = tile.first[1]; j < tile.end(1); ++j)
      for (int i = tile.first[0]; i < tile.end(0); ++i)
        if (is_at_interface({i, j, k})) found[label({i, j, k})].push_back({i, j, k});
  return found;
}

LabelGrowth::Faces LabelGrowth::faces_of(const Voxel& v) const {
  const std::size_t own = grid_.at(v[0], v[1], v[2]);
  Faces faces;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      Voxel n = v;
      n[axis] += step;
      if (n[axis] < 0 || n[axis] >= image_.size[axis]) continue;
      const std::size_t other = grid_.at(n[0], n[1], n[2]);
      if (image_.voxels[other] == image_.voxels[own]) continue;
      faces.area += area_[axis];
      faces.lead += area_[axis] * (std::int64_t{voxel_weights_[own]} - std::int64_t{voxel_weights_[other]});
    }
  return faces;
}

std::uint16_t LabelGrowth::weight_without_growth(const Faces& near, std::uint16_t weight,
                                                 std::uint16_t least) const {
  const double growth =
      near.area == 0 ? 0 : static_cast<double>(near.lead) / static_cast<double>(2 * near.area);
  return static_cast<std::uint16_t>(
      std::clamp(std::round(weight - growth), 1.0 * least, 1.0 * kFullVoxelWeight));
}

std::vector<std::uint16_t> LabelGrowth::without_growth(std::uint16_t least) const {
  std::vector<std::uint16_t> result = voxel_weights_;
  const std::vector<VoxelBox> tiles = tiles_of(image_.size);
  parallel_ranges(tiles.size(), threads_, [&](std::size_t begin, std::size_t end, std::size_t) {
    Table table(*this);
    for (std::size_t t = begin; t < end; ++t)
      for (const auto& [label, voxels] : at_interfaces(tiles[t])) {
        table.fill(tiles[t].grown(reach_).common(grid_), label);
        for (const Voxel& v : voxels) {
          const Faces near = table.in(VoxelBox{v, {1, 1, 1}}.grown(reach_).common(grid_));
          std::uint16_t& weight = result[grid_.at(v[0], v[1], v[2])];
          weight = weight_without_growth(near, weight, least);
        }
      }
  });
  return result;
}

}  // namespace podm::verify
