// The topology of the labels of an image: regions, and the handles and cavities of each.
//
// Two readings of an image are usual. In the 6-reading faces alone join voxels of a label. In the 26-reading
// edges and corners join them, too. Where the readings differ, the image does not say what it shows, and a
// label function may follow either. Such places are *ambiguous*: edges with two voxels of the label at
// opposite sides and none at the other two; and corners, without such edges, whose link is neither empty nor
// a disk nor all of the sphere (corner_voxels.h). At an ambiguous place the region follows the caller, who
// says which label is there: usually that of a mesh of the image. Everywhere else both readings agree.
//
// With these choices the region is a set of voxels, faces, edges and corners. Thickened a little it is a
// compact 3-manifold with boundary surfaces.
//   Components: voxels, joined by faces, and by edges and corners that are in the label.
//   Euler characteristic: built up from voxels, faces, edges, corners, in this order, each adds 1 minus the
//   Euler characteristic of what of its surroundings is there already: 1 for a voxel, -1 for a face, 1 - chi
//   of the link for a corner.
//   Cavities b2: a component with n boundary surfaces separates space into n parts, of which one is the
//   outside: n - 1 cavities. Two faces of the boundary belong to one surface if a corner at both connects
//   them: through the label around the corner, or, if the corner is in the label, around it.
//   Handles b1 = 1 + b2 - chi.
// Everything beyond the grid is background. The background itself is not examined.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/point.h"
#include "image/components.h"
#include "podm/label_image.h"

namespace podm {

struct ImageRegion {
  LabelIndex label = kBackground;
  std::uint64_t num_voxels = 0;
  Voxel first, low, high;  ///< the first voxel, and the bounds of all
  std::int64_t handles = 0, cavities = 0;
  std::uint64_t ambiguous = 0;   ///< ambiguous places at its voxels
  std::uint64_t num_joined = 0;  ///< its parts that faces join
  std::uint32_t group = 0;       ///< regions that ambiguous places would join are of one group
};

struct AmbiguousPlace {
  Point at;  ///< in voxels
  LabelIndex label;
};

class ImageRegions {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  /// Says which label is at a place, which is given in voxels.
  using LabelAt = std::function<LabelIndex(const Point&)>;

  /// Takes 4 bytes per voxel meanwhile.
  ImageRegions(const LabelImage& image, const LabelAt& label_at);

  std::size_t size() const { return regions_.size(); }
  const ImageRegion& operator[](std::uint32_t region) const { return regions_[region]; }
  /// The region of a voxel in the grid; kNone for the background.
  std::uint32_t of(const Voxel& v) const { return region_of_part_[parts_.of(v)]; }
  /// The parts of regions that faces join, with those of the background. `part_of` needs a voxel in the grid.
  std::uint32_t num_parts() const { return static_cast<std::uint32_t>(parts_.size()); }
  std::uint32_t part_of(const Voxel& v) const { return parts_.of(v); }
  std::uint32_t region_of_part(std::uint32_t part) const { return region_of_part_[part]; }
  /// The ambiguous places of the image. A point may be one for several labels.
  const std::vector<AmbiguousPlace>& ambiguous_places() const { return ambiguous_places_; }

 private:
  friend class RegionFinder;
  Components parts_;  // joined by faces
  std::vector<std::uint32_t> region_of_part_;
  std::vector<ImageRegion> regions_;
  std::vector<AmbiguousPlace> ambiguous_places_;
};

}  // namespace podm
