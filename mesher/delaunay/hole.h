// Filling any region by gift wrapping: removal of vertices, and insertions whose cavity is out of the
// ordinary.
//
// From a boundary facet the next cell's apex is the one vertex on its inner side whose circumsphere with the
// facet holds no other candidate. Candidates are all vertices of the region that stay, and the new vertex. By
// the uniqueness of the perturbed triangulation the cells found from different facets fit together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/region.h"

namespace podm {

class HoleFiller {
 public:
  /// Replaces the region by the Delaunay cells of its remaining vertices and `added` (or kNoVertex).
  void fill(Mesh& mesh, Pool& pool, Region& region, VertexId added);

 private:
  struct OpenFacet {
    std::array<std::uint16_t, 3> local;  // counter-clockwise seen from inside the hole
    FacetId mirror;                      // what lies on its other side
  };
  struct Slot {
    std::uint64_t key = 0;  // the three local indices, sorted; 0: empty
    std::uint32_t open = 0;
  };

  void collect(Mesh& mesh, const Region& region, VertexId added);
  std::uint16_t local_of(Mesh& mesh, VertexId v);
  unsigned apex_of(const Mesh& mesh, const OpenFacet& facet);
  unsigned nearest_apex(const OpenFacet& facet);
  void add_or_match(Mesh& mesh, const OpenFacet& facet);
  Slot& slot_of(std::uint64_t key);
  void rebuild_table(std::size_t size);

  std::vector<VertexId> ids_;
  std::vector<Point> points_;
  std::vector<std::uint8_t> is_inner_;  // candidate on the inner side of the facet at hand
  std::vector<OpenFacet> open_;
  std::vector<std::uint8_t> is_closed_;
  std::vector<Slot> table_;  // open addressing, power of two
  std::size_t used_slots_ = 0;
};

}  // namespace podm
