// Fills any region by gift wrapping: removals of vertices, and insertions with an unusual cavity.
//
// From a boundary facet, the next cell's apex is the one vertex on the inner side whose circumsphere with the
// facet contains no other candidate. Candidates are all vertices of the region that stay, and the new vertex.
// The perturbed triangulation is unique. Therefore the cells found from different facets fit together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/pool.h"
#include "delaunay/region.h"

namespace podm {

class HoleFiller {
 public:
  static constexpr std::size_t kMaxVertices = 0xffff;
  explicit HoleFiller(std::size_t max_vertices = kMaxVertices) : max_vertices_(max_vertices) {}

  /// Finds the Delaunay cells of the region's remaining vertices and of `added`, if given. Writes nothing
  /// except the scratch Vertex::local_index. Returns false if there are more vertices than it can number.
  bool plan(Mesh& mesh, const Region& region, const Point* added);
  std::size_t num_cells() const { return cells_.size(); }
  /// Lists the planned cells, none of which may have an added vertex, as they would be stored from the id
  /// `first` on.
  void list(const Mesh& mesh, CellId first, std::vector<Cell>& cells) const;
  /// Replaces the region by the planned cells. `added` is the vertex whose point was given, or kNoVertex.
  void fill(Mesh& mesh, Pool& pool, Region& region, VertexId added);

 private:
  using Local = std::uint16_t;  // a vertex, as numbered by the plan
  // A facet of the triangulation or of the planned cells, which have no ids yet: 4 * number + index.
  struct FacetRef {
    FacetId facet;
    bool is_planned;
  };
  struct OpenFacet {
    std::array<Local, 3> local;  // counter-clockwise seen from inside the hole
    FacetRef other;
  };
  struct Slot {
    std::uint64_t key = 0;  // the three local indices, sorted; 0: empty
    std::uint32_t open = 0;
  };

  bool collect(Mesh& mesh, const Region& region, const Point* added);
  Local local_of(Mesh& mesh, VertexId v);
  Local add_local(VertexId v, const Point& p);
  Local apex_of(const Mesh& mesh, const OpenFacet& facet);
  bool is_inner(const OpenFacet& facet, std::size_t i) const;
  unsigned nearest_apex(const OpenFacet& facet) const;
  void add_or_match(const OpenFacet& facet);
  Slot& slot_of(std::uint64_t key);
  void rebuild_table(std::size_t size);

  static constexpr unsigned kNoApex = 0xffffffffu;

  std::size_t max_vertices_;
  std::vector<VertexId> ids_;  // kNoVertex: the added vertex
  std::vector<Point> points_;
  unsigned added_ = kNoApex;  // the added vertex's index in ids_ and points_
  std::vector<OpenFacet> open_;
  std::vector<std::uint8_t> is_closed_;
  std::vector<Slot> table_;  // open addressing, power of two
  std::size_t used_slots_ = 0;
  std::vector<std::array<Local, 4>> cells_;
  std::vector<std::array<FacetRef, 2>> glued_;
};

}  // namespace podm
