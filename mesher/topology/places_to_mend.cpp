#include "topology/places_to_mend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "topology/labels_at_places.h"
#include "topology/simple_voxel.h"

namespace podm {

namespace {

struct VoxelBox {
  Voxel low, high;

  bool contains(const Voxel& v) const {
    return v.i >= low.i && v.j >= low.j && v.k >= low.k && v.i <= high.i && v.j <= high.j && v.k <= high.k;
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int k = low.k; k <= high.k; ++k)
      for (int j = low.j; j <= high.j; ++j)
        for (int i = low.i; i <= high.i; ++i) visit(Voxel{i, j, k});
  }
};

VoxelBox box_of_all(const LabelImage& image) {
  return {{0, 0, 0}, {image.size[0] - 1, image.size[1] - 1, image.size[2] - 1}};
}

VoxelBox clipped(const VoxelBox& box, const LabelImage& image) {
  const VoxelBox all = box_of_all(image);
  return {
      {std::max(box.low.i, 0), std::max(box.low.j, 0), std::max(box.low.k, 0)},
      {std::min(box.high.i, all.high.i), std::min(box.high.j, all.high.j), std::min(box.high.k, all.high.k)}};
}

VoxelBox around(const VoxelBox& box, const LabelImage& image) {
  return clipped(
      {{box.low.i - 1, box.low.j - 1, box.low.k - 1}, {box.high.i + 1, box.high.j + 1, box.high.k + 1}},
      image);
}

// Deforms the image of one label in a box towards the mesh.
class Warp {
 public:
  Warp(const Mesh& mesh, const LabelImage& image, LabelIndex label, const VoxelBox& box)
      : image_(image),
        box_(box),
        size_{box.high.i - box.low.i + 3, box.high.j - box.low.j + 3, box.high.k - box.low.k + 3},
        has_label_(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                   static_cast<std::size_t>(size_[2])) {
    around({box.low, box.high}, image).for_each([&](const Voxel& v) {
      has_label_[index(v)] = image.voxels[image.index(v.i, v.j, v.k)] == label;
    });
    LabelsAtPlaces label_in_mesh(mesh, image);
    box.for_each([&](const Voxel& v) {
      const Around27 set = around_of(v);
      if ((set | simple_voxel::kMiddle) == simple_voxel::kAll && has_label_[index(v)] != 0) return;
      if ((set & ~simple_voxel::kMiddle) == 0 && has_label_[index(v)] == 0) return;
      if ((label_in_mesh(center(v)) == label) != (has_label_[index(v)] != 0)) differing_.push_back(v);
    });
  }

  const std::vector<Voxel>& differing() const { return differing_; }

  /// The voxels that differ after the deformation.
  std::vector<Voxel> rest() {
    std::vector<Voxel> left = differing_;
    for (std::size_t before = 0; before != left.size();) {
      before = left.size();
      std::vector<Voxel> still;
      for (const Voxel& v : left) {
        if (is_simple(around_of(v))) {
          has_label_[index(v)] ^= 1;
        } else {
          still.push_back(v);
        }
      }
      left = std::move(still);
    }
    return left;
  }

 private:
  std::size_t index(const Voxel& v) const {
    const auto along = [](int at, int low) { return static_cast<std::size_t>(at - low + 1); };
    return (along(v.k, box_.low.k) * static_cast<std::size_t>(size_[1]) + along(v.j, box_.low.j)) *
               static_cast<std::size_t>(size_[0]) +
           along(v.i, box_.low.i);
  }
  Around27 around_of(const Voxel& v) const {
    Around27 set = 0;
    unsigned bit = 0;
    for (int k = v.k - 1; k <= v.k + 1; ++k)
      for (int j = v.j - 1; j <= v.j + 1; ++j)
        for (int i = v.i - 1; i <= v.i + 1; ++i, ++bit)
          set |= static_cast<Around27>(has_label_[index({i, j, k})]) << bit;
    return set;
  }

  const LabelImage& image_;
  const VoxelBox box_;
  const std::array<int, 3> size_;        // of the box with a voxel more on each side
  std::vector<std::uint8_t> has_label_;  // of the deformed image
  std::vector<Voxel> differing_;
};

class Places {
 public:
  Places(const Mesh& mesh, const MeshRegions& of_mesh, const LabelImage& image, const ImageRegions& of_image)
      : mesh_(mesh), of_mesh_(of_mesh), image_(image), of_image_(of_image) {}

  std::vector<std::size_t> operator()(const RegionDifference& difference) {
    if (difference.kind == TopologyDifference::kLost) return voxels_of_part(difference);
    std::vector<std::size_t> found;
    const bool is_in_pieces =
        difference.kind == TopologyDifference::kSpurious || difference.kind == TopologyDifference::kSplit;
    const std::size_t first = difference.kind == TopologyDifference::kSplit ? 1 : 0;
    for (std::size_t i = first; is_in_pieces && i < difference.mesh_regions.size(); ++i)
      append_box(difference.mesh_regions[i], found);
    if (!found.empty()) return found;
    if (difference.image_region == kNoRegion) return where_voxels_differ(difference);
    auto& known = of_region_[difference.image_region];  // a region may have several differences
    if (known.empty()) known = where_voxels_differ(difference);
    return known;
  }

 private:
  static constexpr std::uint64_t kMostVoxelsOfPiece = 4096;

  void append(const Voxel& v, std::vector<std::size_t>& voxels) const {
    voxels.push_back(image_.index(v.i, v.j, v.k));
  }
  VoxelBox box_of(const MeshRegion& region) const {
    const auto down = [](double x) { return static_cast<int>(std::floor(x)); };
    return clipped({{down(region.low.x), down(region.low.y), down(region.low.z)},
                    {down(region.high.x) + 1, down(region.high.y) + 1, down(region.high.z) + 1}},
                   image_);
  }
  void append_box(std::uint32_t region, std::vector<std::size_t>& voxels) const {
    const VoxelBox box = box_of(of_mesh_[region]);
    std::uint64_t count = 0;
    box.for_each([&](const Voxel&) { ++count; });
    if (count <= kMostVoxelsOfPiece) box.for_each([&](const Voxel& v) { append(v, voxels); });
  }

  std::vector<std::size_t> voxels_of_part(const RegionDifference& lost) const {
    std::vector<std::size_t> voxels;
    const ImageRegion& of = of_image_[lost.image_region];
    VoxelBox{of.low, of.high}.for_each([&](const Voxel& v) {
      if (of_image_.part_of(v) == lost.part) append(v, voxels);
    });
    return voxels;
  }
  std::vector<std::size_t> border_of_region(std::uint32_t region) const {
    std::vector<std::size_t> voxels;
    const ImageRegion& of = of_image_[region];
    VoxelBox{of.low, of.high}.for_each([&](const Voxel& v) {
      if (of_image_.of(v) == region && is_at_other(v)) append(v, voxels);
    });
    return voxels;
  }
  bool is_at_other(const Voxel& v) const {
    const VoxelBox all = box_of_all(image_);
    const LabelIndex label = image_.voxels[image_.index(v.i, v.j, v.k)];
    for (const Voxel& w : {Voxel{v.i - 1, v.j, v.k}, Voxel{v.i + 1, v.j, v.k}, Voxel{v.i, v.j - 1, v.k},
                           Voxel{v.i, v.j + 1, v.k}, Voxel{v.i, v.j, v.k - 1}, Voxel{v.i, v.j, v.k + 1}})
      if (!all.contains(w) || image_.voxels[image_.index(w.i, w.j, w.k)] != label) return true;
    return false;
  }

  std::vector<std::size_t> where_voxels_differ(const RegionDifference& difference) const {
    std::vector<std::size_t> voxels;
    const bool is_in_image = difference.image_region != kNoRegion;
    const LabelIndex label = is_in_image ? of_image_[difference.image_region].label
                                         : of_mesh_[difference.mesh_regions.front()].label;
    VoxelBox box = is_in_image ? VoxelBox{of_image_[difference.image_region].low,
                                          of_image_[difference.image_region].high}
                               : box_of(of_mesh_[difference.mesh_regions.front()]);
    box = around(around(box, image_), image_);
    Warp warp(mesh_, image_, label, box);
    for (const Voxel& v : warp.rest()) append(v, voxels);
    if (voxels.empty())
      for (const Voxel& v : warp.differing()) append(v, voxels);
    if (voxels.empty() && is_in_image) return border_of_region(difference.image_region);
    if (voxels.empty()) box.for_each([&](const Voxel& v) { append(v, voxels); });
    return voxels;
  }

  static constexpr std::uint32_t kNoRegion = ImageRegions::kNone;
  const Mesh& mesh_;
  const MeshRegions& of_mesh_;
  const LabelImage& image_;
  const ImageRegions& of_image_;
  std::map<std::uint32_t, std::vector<std::size_t>> of_region_;  // of the image: where voxels differ
};

}  // namespace

std::vector<PlacesToMend> places_to_mend(const std::vector<RegionDifference>& differences, const Mesh& mesh,
                                         const MeshRegions& of_mesh, const LabelImage& image,
                                         const ImageRegions& of_image) {
  Places places(mesh, of_mesh, image, of_image);
  std::vector<PlacesToMend> found;
  for (std::size_t i = 0; i < differences.size(); ++i)
    if (!differences[i].is_ambiguous) found.push_back({i, places(differences[i])});
  return found;
}

}  // namespace podm
