#include "topology/image_regions.h"

#include <algorithm>
#include <array>

#include "topology/corner_voxels.h"
#include "topology/disjoint_sets.h"

namespace podm {

// Looks at all corners of the grid. A voxel, a face and an edge count at the lowest corner of theirs, where
// the voxel is number 7 of the eight.
class RegionFinder {
 public:
  RegionFinder(const LabelImage& image, const ImageRegions::LabelAt& label_at, ImageRegions& found)
      : image_(image),
        label_at_(label_at),
        found_(found),
        sides_of_voxel_(number_sides()),
        surfaces_(num_sides_),
        regions_(found.parts_.size()),
        groups_(found.parts_.size()),
        euler_(found.parts_.size(), 0) {}

  void operator()() {
    for (int k = 0; k <= image_.size[2]; ++k)
      for (int j = 0; j <= image_.size[1]; ++j)
        for (int i = 0; i <= image_.size[0]; ++i) look_at({i, j, k});
    number_regions();
    count_cavities();
  }

 private:
  static constexpr std::uint32_t kNoSides = 0xffffffff;
  static constexpr unsigned kSides = 6;  // side 2 a + u of a voxel is across axis a, up if u is 1

  bool is_inside(const Voxel& v) const {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < image_.size[0] && v.j < image_.size[1] &&
           v.k < image_.size[2];
  }
  LabelIndex label_at(const Voxel& v) const {
    return is_inside(v) ? image_.voxels[image_.index(v.i, v.j, v.k)] : kBackground;
  }
  static Voxel beside(const Voxel& v, unsigned side) {
    const int step = side % 2 != 0 ? 1 : -1;
    return {v.i + (side / 2 == 0 ? step : 0), v.j + (side / 2 == 1 ? step : 0),
            v.k + (side / 2 == 2 ? step : 0)};
  }

  // Numbers the sides of voxels that are at another label.
  std::vector<std::uint32_t> number_sides() {
    std::vector<std::uint32_t> first(image_.voxels.size(), kNoSides);
    std::size_t number = 0;
    for (int k = 0; k < image_.size[2]; ++k)
      for (int j = 0; j < image_.size[1]; ++j)
        for (int i = 0; i < image_.size[0]; ++i, ++number) {
          const LabelIndex label = image_.voxels[number];
          if (label == kBackground) continue;
          for (unsigned side = 0; side < kSides; ++side)
            if (label_at(beside({i, j, k}, side)) != label) {
              first[number] = num_sides_;
              num_sides_ += kSides;
              break;
            }
        }
    return first;
  }

  // Voxel 7 of the eight at a corner is the voxel with the corner's own indices.
  static Voxel voxel_at(const Voxel& corner, unsigned number) {
    return {corner.i - 1 + static_cast<int>(number & 1), corner.j - 1 + static_cast<int>(number >> 1 & 1),
            corner.k - 1 + static_cast<int>(number >> 2)};
  }
  std::uint32_t part_at(const Voxel& corner, unsigned number) const {
    return found_.parts_.of(voxel_at(corner, number));
  }

  void look_at(const Voxel& corner) {
    std::array<LabelIndex, 8> labels;
    bool is_uniform = true;
    for (unsigned v = 0; v < 8; ++v) {
      labels[v] = label_at(voxel_at(corner, v));
      is_uniform = is_uniform && labels[v] == labels[0];
    }
    if (is_uniform) return;
    VoxelMask left = kAllVoxels;
    for (unsigned v = 0; v < 8; ++v) {
      if ((left >> v & 1) == 0) continue;
      VoxelMask mask = 0;
      for (unsigned w = v; w < 8; ++w) mask |= static_cast<VoxelMask>(labels[w] == labels[v]) << w;
      left &= ~mask;
      if (labels[v] != kBackground) look_at(corner, labels[v], mask);
    }
  }

  static Point place_of(const Voxel& corner) { return {corner.i - 0.5, corner.j - 0.5, corner.k - 0.5}; }
  static Point middle_of_edge(const Voxel& corner, unsigned e) {
    const double step = e % 2 != 0 ? 0.5 : -0.5;
    return place_of(corner) + Vector{e / 2 == 0 ? step : 0, e / 2 == 1 ? step : 0, e / 2 == 2 ? step : 0};
  }

  // The ambiguous edges that are in the label.
  EdgeMask joining_edges(const Voxel& corner, LabelIndex label, EdgeMask ambiguous) const {
    EdgeMask joining = 0;
    for (unsigned e = 0; e < 6; ++e) {
      if ((ambiguous >> e & 1) == 0) continue;
      if (label_at_(middle_of_edge(corner, e)) == label) joining |= 1u << e;
    }
    return joining;
  }

  void look_at(const Voxel& corner, LabelIndex label, VoxelMask mask) {
    const EdgeMask ambiguous = ambiguous_edges(mask), joining = joining_edges(corner, label, ambiguous);
    const Pieces pieces(mask, joining);
    const int link = euler_of_link(mask, joining);
    const bool is_plain = pieces.count() == 1 && link == 1;  // a disk
    const bool is_in = !is_plain && label_at_(place_of(corner)) == label;
    if (ambiguous == 0 && !is_plain) note_ambiguous(corner, mask, {place_of(corner), label});
    count_at_lowest(corner, label, mask, ambiguous, joining);
    for (unsigned e = 0; e < 6; ++e)
      if ((joining >> e & 1) != 0) join_all(regions_, corner, mask & ambiguous_pair(mask, e));
    if (is_in) {
      join_all(regions_, corner, mask);
      euler_[part_at(corner, first_of(mask))] += 1 - link;
      connect_sides(corner, mask, Pieces(kAllVoxels & ~mask, ambiguous & ~joining), true);
    } else {
      connect_sides(corner, mask, pieces, false);
    }
  }

  static unsigned first_of(VoxelMask mask) { return static_cast<unsigned>(std::countr_zero(mask)); }
  // The two voxels of the label at an ambiguous edge.
  static VoxelMask ambiguous_pair(VoxelMask mask, unsigned edge) {
    VoxelMask around = 0;
    for (const unsigned v : kVoxelsAroundEdge[edge]) around |= 1u << v;
    return mask & around;
  }

  void join_all(DisjointSets& sets, const Voxel& corner, VoxelMask mask) const {
    const std::uint32_t first = part_at(corner, first_of(mask));
    for (unsigned v = 0; v < 8; ++v)
      if ((mask >> v & 1) != 0) sets.join(first, part_at(corner, v));
  }

  void note_ambiguous(const Voxel& corner, VoxelMask mask, const AmbiguousPlace& place) {
    found_.ambiguous_places_.push_back(place);
    const unsigned last = 31u - static_cast<unsigned>(std::countl_zero(mask));
    ambiguous_.push_back({part_at(corner, first_of(mask)), part_at(corner, last)});
    join_all(groups_, corner, mask);
  }

  // Voxel 7, its three faces and the three edges up from the corner.
  void count_at_lowest(const Voxel& corner, LabelIndex label, VoxelMask mask, EdgeMask ambiguous,
                       EdgeMask joining) {
    const auto has = [&](unsigned v) { return (mask >> v & 1) != 0; };
    int euler = has(7) ? 1 : 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      euler -= has(7) && has(7 ^ 1u << axis);
      const unsigned edge = 2 * axis + 1;
      const auto& around = kVoxelsAroundEdge[edge];
      euler += std::all_of(around.begin(), around.end(), has);
      if ((ambiguous >> edge & 1) == 0) continue;
      const VoxelMask pair = ambiguous_pair(mask, edge);
      note_ambiguous(corner, pair, {middle_of_edge(corner, edge), label});
      if ((joining >> edge & 1) != 0) --euler_[part_at(corner, first_of(pair))];
    }
    if (has(7)) euler_[part_at(corner, 7)] += euler;
  }

  // Puts the sides at the corner that border one piece on one surface: a piece of the label, or of the rest.
  void connect_sides(const Voxel& corner, VoxelMask mask, const Pieces& pieces, bool is_of_rest) {
    std::array<std::uint32_t, 8> known;
    known.fill(kNoSides);
    for (unsigned v = 0; v < 8; ++v) {
      if ((mask >> v & 1) == 0) continue;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned w = v ^ 1u << axis;
        if ((mask >> w & 1) != 0) continue;
        const Voxel at = voxel_at(corner, v);
        const std::uint32_t side =
            sides_of_voxel_[image_.index(at.i, at.j, at.k)] + 2 * axis + ((v >> axis & 1) == 0);
        std::uint32_t& first = known[pieces.of(is_of_rest ? w : v)];
        if (first == kNoSides) first = side;
        surfaces_.join(first, side);
      }
    }
  }

  void number_regions() {
    const Components& parts = found_.parts_;
    found_.region_of_part_.assign(parts.size(), ImageRegions::kNone);
    for (std::uint32_t part = 0; part < parts.size(); ++part) {
      if (parts[part].label == kBackground) continue;
      groups_.join(part, regions_.root(part));
      std::uint32_t& region = found_.region_of_part_[regions_.root(part)];
      if (region == ImageRegions::kNone) {
        region = static_cast<std::uint32_t>(found_.regions_.size());
        found_.regions_.push_back({.label = parts[part].label,
                                   .first = parts[part].first,
                                   .low = parts[part].first,
                                   .high = parts[part].first});
      }
      found_.region_of_part_[part] = region;
      ImageRegion& of = found_.regions_[region];
      of.num_voxels += parts[part].num_voxels;
      ++of.num_joined;
      of.handles -= euler_[part];
    }
    for (std::uint32_t part = 0; part < parts.size(); ++part)
      if (const std::uint32_t region = found_.region_of_part_[part]; region != ImageRegions::kNone)
        found_.regions_[region].group = groups_.root(part);
    for (const auto& [a, b] : ambiguous_) {
      const std::uint32_t of_a = found_.region_of_part_[a], of_b = found_.region_of_part_[b];
      ++found_.regions_[of_a].ambiguous;
      if (of_b != of_a) ++found_.regions_[of_b].ambiguous;
    }
    bound_regions();
  }

  void bound_regions() {
    found_.parts_.for_each_run([&](Components::Id part, const Voxel& v, int length) {
      const std::uint32_t number = found_.region_of_part_[part];
      if (number == ImageRegions::kNone) return;
      ImageRegion& region = found_.regions_[number];
      region.low = {std::min(region.low.i, v.i), std::min(region.low.j, v.j), std::min(region.low.k, v.k)};
      region.high = {std::max(region.high.i, v.i + length - 1), std::max(region.high.j, v.j),
                     std::max(region.high.k, v.k)};
    });
  }

  void count_cavities() {
    std::vector<char> is_counted(surfaces_.size());
    found_.parts_.for_each_run([&](Components::Id part, const Voxel& first, int length) {
      if (found_.region_of_part_[part] == ImageRegions::kNone) return;
      ImageRegion& region = found_.regions_[found_.region_of_part_[part]];
      for (Voxel v = first; v.i < first.i + length; ++v.i) {
        const std::uint32_t sides = sides_of_voxel_[image_.index(v.i, v.j, v.k)];
        for (unsigned side = 0; sides != kNoSides && side < kSides; ++side) {
          if (label_at(beside(v, side)) == region.label) continue;
          const std::uint32_t surface = surfaces_.root(sides + side);
          region.cavities += is_counted[surface] == 0;
          is_counted[surface] = 1;
        }
      }
    });
    for (ImageRegion& region : found_.regions_) {
      --region.cavities;                      // one surface is the outer one
      region.handles += 1 + region.cavities;  // it was minus the Euler characteristic
    }
  }

  const LabelImage& image_;
  const ImageRegions::LabelAt& label_at_;
  ImageRegions& found_;
  std::uint32_t num_sides_ = 0;
  std::vector<std::uint32_t> sides_of_voxel_;            // the number of its first side, or kNoSides
  DisjointSets surfaces_;                                // of sides
  DisjointSets regions_, groups_;                        // of parts
  std::vector<std::int64_t> euler_;                      // by part
  std::vector<std::array<std::uint32_t, 2>> ambiguous_;  // two parts, or one twice, at each ambiguous place
};

ImageRegions::ImageRegions(const LabelImage& image, const LabelAt& label_at) : parts_(image) {
  RegionFinder(image, label_at, *this)();
}

}  // namespace podm
