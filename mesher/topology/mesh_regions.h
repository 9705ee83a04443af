// The topology of the labels of a mesh: regions, and the handles and cavities of each.
//
// A region is the interior of the union of cells of one label that facets join. Where two fans of its cells
// meet at an edge or a vertex alone, that edge or vertex is not in it: it joins nothing. Shrunken a little
// the region is a compact 3-manifold with boundary surfaces.
//   Euler characteristic: half of that of the boundary, which is counted on the shrunken surfaces. Facets are
//   paired around their edges through the region, so F facets have 3 F / 2 edges. Around a vertex the cells
//   of the region form fans, joined by facets at the vertex. The boundary facets of a fan form k cycles. The
//   link of the fan is a sphere without k disks, and so is the part of the shrunken boundary near the vertex
//   beside these facets. It adds 2 - k.
//   Cavities b2: the number of surfaces minus one. Two cycles of one fan are on one surface.
//   Handles b1 = 1 + b2 - chi.
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "geometry/affine.h"
#include "podm/label_image.h"

namespace podm {

struct MeshRegion {
  LabelIndex label = kBackground;
  std::uint64_t num_cells = 0;
  CellId first = 0;
  Point low, high;  ///< bounds, in voxels
  std::int64_t handles = 0, cavities = 0;
};

class MeshRegions {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  /// The label of every living cell must be known. Takes 8 bytes per cell of the store, and meanwhile about
  /// 40 per cell at an interface. `to_voxels` maps points of the mesh to voxels.
  MeshRegions(const Mesh& mesh, const Affine& to_voxels);

  std::size_t size() const { return regions_.size(); }
  const MeshRegion& operator[](std::uint32_t region) const { return regions_[region]; }
  /// kNone for cells of the background and for dead cells.
  std::uint32_t of(CellId c) const { return region_of_cell_[c]; }

 private:
  friend class MeshRegionFinder;
  std::vector<std::uint32_t> region_of_cell_;
  std::vector<MeshRegion> regions_;
};

}  // namespace podm
