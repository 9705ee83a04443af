#include "topology/compare_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <tuple>
#include <unordered_map>

#include "geometry/affine.h"
#include "geometry/box.h"
#include "image/working_frame.h"

namespace podm {

namespace {

constexpr std::uint32_t kNone = ImageRegions::kNone;

class Comparison {
 public:
  Comparison(const Mesh& mesh, const MeshRegions& of_mesh, const LabelImage& image,
             const ImageRegions& of_image)
      : mesh_(mesh),
        of_mesh_(of_mesh),
        image_(image),
        of_image_(of_image),
        to_voxels_(inverse(voxels_to_working(image))),
        match_(of_mesh.size(), kNone),
        most_(of_mesh.size(), 0),
        matching_(of_image.size()),
        reaching_(of_image.size()),
        has_centroid_(of_image.num_parts()) {}

  std::vector<RegionDifference> operator()() {
    match();
    for (std::uint32_t region = 0; region < of_mesh_.size(); ++region)
      if (match_[region] == kNone)
        add(TopologyDifference::kSpurious, is_at_ambiguous_place(of_mesh_[region]), kNone, {region});
    for (std::uint32_t part = 0; part < of_image_.num_parts(); ++part)
      if (of_image_.region_of_part(part) != kNone && has_centroid_[part] == 0) {
        add(TopologyDifference::kLost, false, of_image_.region_of_part(part), {});
        found_.back().part = part;
      }
    for (std::uint32_t region = 0; region < of_image_.size(); ++region) compare(region);
    std::stable_sort(found_.begin(), found_.end(), [](const RegionDifference& a, const RegionDifference& b) {
      return std::tuple(a.kind, a.image_region) < std::tuple(b.kind, b.image_region);
    });
    return std::move(found_);
  }

 private:
  Voxel voxel_of(CellId c) const {
    const auto& v = mesh_.cell(c).vertices;
    const Point &a = mesh_.point(v[0]), &b = mesh_.point(v[1]), &d = mesh_.point(v[2]),
                &e = mesh_.point(v[3]);
    const Point u = map(to_voxels_, Point{(a.x + b.x + d.x + e.x) / 4, (a.y + b.y + d.y + e.y) / 4,
                                          (a.z + b.z + d.z + e.z) / 4});
    const auto near = [](double x) { return static_cast<int>(std::floor(x + 0.5)); };
    return {near(u.x), near(u.y), near(u.z)};
  }
  bool is_at_ambiguous_place(const MeshRegion& region) const {
    constexpr double kMostVoxels = 2, kNearVoxels = 0.5;
    const Vector extent = region.high - region.low, near{kNearVoxels, kNearVoxels, kNearVoxels};
    if (std::max({extent.x, extent.y, extent.z}) > kMostVoxels) return false;
    const Box box{region.low - near, region.high + near};
    const auto& places = of_image_.ambiguous_places();
    return std::any_of(places.begin(), places.end(), [&](const AmbiguousPlace& place) {
      return place.label == region.label && is_in(box, place.at);
    });
  }

  void add(TopologyDifference kind, bool is_ambiguous, std::uint32_t of_image,
           const std::vector<std::uint32_t>& of_mesh) {
    found_.push_back({kind, is_ambiguous, of_image, kNone, of_mesh});
  }
  // The region of the image with the cell's label at its centroid.
  std::uint32_t region_at(CellId c) {
    const Voxel v = voxel_of(c);
    const bool is_inside = v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < image_.size[0] && v.j < image_.size[1] &&
                           v.k < image_.size[2];
    if (!is_inside || image_.voxels[image_.index(v.i, v.j, v.k)] != mesh_.label(c)) return kNone;
    has_centroid_[of_image_.part_of(v)] = 1;
    return of_image_.of(v);
  }

  void match() {
    std::unordered_map<std::uint64_t, std::uint64_t> centroids;  // by both regions
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (of_mesh_.of(c) == MeshRegions::kNone) continue;
      if (const std::uint32_t region = region_at(c); region != kNone)
        ++centroids[std::uint64_t{of_mesh_.of(c)} << 32 | region];
    }
    const std::map<std::uint64_t, std::uint64_t> sorted(centroids.begin(), centroids.end());
    for (const auto& [regions, count] : sorted) {
      const auto of_mesh = static_cast<std::uint32_t>(regions >> 32),
                 of_image = static_cast<std::uint32_t>(regions);
      reaching_[of_image].push_back(of_mesh);
      if (count <= most_[of_mesh]) continue;
      most_[of_mesh] = count;
      match_[of_mesh] = of_image;
    }
    for (std::uint32_t region = 0; region < of_mesh_.size(); ++region)
      if (match_[region] != kNone) matching_[match_[region]].push_back(region);
    for (auto& regions : matching_)
      std::stable_sort(regions.begin(), regions.end(), [&](std::uint32_t a, std::uint32_t b) {
        return of_mesh_[a].num_cells > of_mesh_[b].num_cells;
      });
  }

  // `matching` begins with the largest piece. If several are the largest, one that is at no ambiguous place
  // counts as it, so that no order of cells decides.
  bool is_split_ambiguous(const ImageRegion& of_image, const std::vector<std::uint32_t>& matching) const {
    const auto size = [&](std::uint32_t region) { return of_mesh_[region].num_cells; };
    std::uint64_t others = 0;
    bool is_largest_away = false;
    for (const std::uint32_t region : matching) {
      if (is_at_ambiguous_place(of_mesh_[region])) continue;
      ++others;
      is_largest_away = is_largest_away || size(region) == size(matching.front());
    }
    return others - (is_largest_away ? 1 : 0) < of_image.num_joined;
  }

  void compare(std::uint32_t region) {
    const ImageRegion& of_image = of_image_[region];
    const auto& matching = matching_[region];
    if (matching.empty() && !reaching_[region].empty()) {
      const ImageRegion& other = of_image_[match_[reaching_[region].front()]];
      add(TopologyDifference::kJoined, other.group == of_image.group, region, reaching_[region]);
    } else if (matching.size() > 1) {
      add(TopologyDifference::kSplit, is_split_ambiguous(of_image, matching), region, matching);
    } else if (matching.size() == 1 && !has_absorbed(matching.front(), region)) {
      compare_numbers(region, matching.front());
    }
  }

  // True if a region of the image other than its match has only this region of the mesh.
  bool has_absorbed(std::uint32_t of_mesh, std::uint32_t match) const {
    if (num_reached_.empty()) {
      num_reached_.assign(of_mesh_.size(), 0);
      for (std::uint32_t region = 0; region < of_image_.size(); ++region)
        if (matching_[region].empty())
          for (const std::uint32_t reaching : reaching_[region]) ++num_reached_[reaching];
    }
    return match_[of_mesh] == match && num_reached_[of_mesh] > 0;
  }

  void compare_numbers(std::uint32_t region, std::uint32_t match) {
    const ImageRegion& of_image = of_image_[region];
    const MeshRegion& of_mesh = of_mesh_[match];
    const std::int64_t handles = std::abs(of_mesh.handles - of_image.handles),
                       cavities = std::abs(of_mesh.cavities - of_image.cavities);
    const bool is_ambiguous = static_cast<std::uint64_t>(handles + cavities) <= of_image.ambiguous;
    if (handles != 0) add(TopologyDifference::kHandles, is_ambiguous, region, {match});
    if (cavities != 0) add(TopologyDifference::kCavities, is_ambiguous, region, {match});
  }

  const Mesh& mesh_;
  const MeshRegions& of_mesh_;
  const LabelImage& image_;
  const ImageRegions& of_image_;
  const Affine to_voxels_;
  std::vector<std::uint32_t> match_;                  // by region of the mesh
  std::vector<std::uint64_t> most_;                   // centroids in it
  std::vector<std::vector<std::uint32_t>> matching_;  // by region of the image: regions that match it
  std::vector<std::vector<std::uint32_t>> reaching_;  // and those with a centroid in it
  std::vector<char> has_centroid_;                    // by part of the image
  mutable std::vector<std::uint32_t> num_reached_;    // regions without a match, by region of the mesh
  std::vector<RegionDifference> found_;
};

}  // namespace

std::vector<RegionDifference> compare_topology(const Mesh& mesh, const MeshRegions& of_mesh,
                                               const LabelImage& image, const ImageRegions& of_image) {
  return Comparison(mesh, of_mesh, image, of_image)();
}

}  // namespace podm
