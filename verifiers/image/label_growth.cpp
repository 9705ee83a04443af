#include "image/label_growth.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "parallel.h"

namespace podm::verify {

// Summed-area tables of the faces of each label: what is in any box is found at its eight corners.
class LabelGrowth::Tables {
 public:
  Tables(const LabelGrowth& growth, const VoxelBox& around) : around_(around) {
    for (int k = around.first[2]; k < around.end(2); ++k)
      for (int j = around.first[1]; j < around.end(1); ++j)
        for (int i = around.first[0]; i < around.end(0); ++i) {
          const Faces faces = growth.faces_of({i, j, k});
          if (faces.area == 0) continue;
          std::vector<Faces>& table = tables_[growth.label({i, j, k})];
          table.resize(corners().count());
          table[corners().at(i + 1, j + 1, k + 1)] = faces;
        }
    for (auto& [label, table] : tables_)
      for (std::size_t axis = 0; axis < 3; ++axis) add_up(axis, table);
  }

  // The box lies in the one around.
  Faces in(const VoxelBox& box, std::uint32_t label) const {
    const auto found = tables_.find(label);
    Faces sum;
    if (found == tables_.end()) return sum;
    for (int corner = 0; corner < 8; ++corner) {
      const auto at = [&](std::size_t axis) {
        return (corner >> axis & 1) != 0 ? box.end(axis) : box.first[axis];
      };
      const int sign = (corner == 7 || corner == 1 || corner == 2 || corner == 4) ? 1 : -1;
      const Faces& below = found->second[corners().at(at(0), at(1), at(2))];
      sum.area += sign * below.area;
      sum.lead += sign * below.lead;
    }
    return sum;
  }

 private:
  VoxelBox corners() const {
    return {around_.first, {around_.size[0] + 1, around_.size[1] + 1, around_.size[2] + 1}};
  }
  void add_up(std::size_t axis, std::vector<Faces>& table) const {
    const VoxelBox all = corners();
    std::size_t stride = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(all.size[a]);
    const auto length = static_cast<std::size_t>(all.size[axis]);
    for (std::size_t at = 0; at < table.size(); ++at)
      if (at / stride % length != 0) {
        table[at].area += table[at - stride].area;
        table[at].lead += table[at - stride].lead;
      }
  }

  VoxelBox around_;
  std::map<std::uint32_t, std::vector<Faces>> tables_;
};

LabelGrowth::LabelGrowth(const Image& image, const std::vector<std::uint16_t>& strengths, double width_mm,
                         int threads)
    : image_(image), strengths_(strengths), threads_(threads), grid_{{}, image.size} {
  const double shortest = *std::min_element(image.spacing.begin(), image.spacing.end());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach_[axis] = static_cast<int>(std::ceil(2 * width_mm / image.spacing[axis]));
    area_[axis] = std::max(std::int64_t{1},
                           static_cast<std::int64_t>(std::round(256 * shortest / image.spacing[axis])));
  }
}

std::uint32_t LabelGrowth::label(const std::array<int, 3>& v) const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (v[axis] < 0 || v[axis] >= image_.size[axis]) return 0;
  return image_.voxels[grid_.at(v[0], v[1], v[2])];
}

bool LabelGrowth::is_at_interface(const std::array<int, 3>& v) const {
  const std::uint32_t own = label(v);
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        if (label({v[0] + i, v[1] + j, v[2] + k}) != own) return true;
  return false;
}

LabelGrowth::Faces LabelGrowth::faces_of(const std::array<int, 3>& v) const {
  const std::size_t own = grid_.at(v[0], v[1], v[2]);
  Faces faces;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      std::array<int, 3> n = v;
      n[axis] += step;
      if (n[axis] < 0 || n[axis] >= image_.size[axis]) continue;
      const std::size_t other = grid_.at(n[0], n[1], n[2]);
      if (image_.voxels[other] == image_.voxels[own]) continue;
      faces.area += area_[axis];
      faces.lead += area_[axis] * (std::int64_t{strengths_[own]} - std::int64_t{strengths_[other]});
    }
  return faces;
}

std::uint16_t LabelGrowth::strength_without(const Faces& near, std::uint16_t strength,
                                            std::uint16_t least) const {
  const double growth =
      near.area == 0 ? 0 : static_cast<double>(near.lead) / static_cast<double>(2 * near.area);
  return static_cast<std::uint16_t>(
      std::clamp(std::round(strength - growth), 1.0 * least, 1.0 * kFullStrength));
}

std::vector<std::uint16_t> LabelGrowth::taken_back(std::uint16_t least) const {
  std::vector<std::uint16_t> result = strengths_;
  const std::vector<VoxelBox> tiles = tiles_of(image_.size);
  parallel_ranges(tiles.size(), threads_, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t t = begin; t < end; ++t) {
      const Tables faces(*this, tiles[t].grown(reach_).common(grid_));
      for (int k = tiles[t].first[2]; k < tiles[t].end(2); ++k)
        for (int j = tiles[t].first[1]; j < tiles[t].end(1); ++j)
          for (int i = tiles[t].first[0]; i < tiles[t].end(0); ++i) {
            if (!is_at_interface({i, j, k})) continue;
            const VoxelBox near = VoxelBox{{i, j, k}, {1, 1, 1}}.grown(reach_).common(grid_);
            std::uint16_t& strength = result[grid_.at(i, j, k)];
            strength = strength_without(faces.in(near, label({i, j, k})), strength, least);
          }
    }
  });
  return result;
}

}  // namespace podm::verify
