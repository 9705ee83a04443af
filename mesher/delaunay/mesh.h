// The store of the triangulation: vertices and cells by 32-bit id, one cache line a cell.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/circumsphere.h"
#include "geometry/point.h"
#include "geometry/tetrahedron.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

using VertexId = std::uint32_t;
using CellId = std::uint32_t;
using FacetId = std::uint32_t;  // 4 * cell + local index, see geometry/tetrahedron.h

inline constexpr VertexId kNoVertex = 0xffffffffu;
inline constexpr FacetId kNoFacet = 0xffffffffu;  // beyond the virtual box
inline constexpr CellId cell_of(FacetId f) { return f >> 2; }
inline constexpr int index_in_cell(FacetId f) { return static_cast<int>(f & 3); }

enum class VertexKind : std::uint8_t {
  kUnused,
  kBox,           // corner of the virtual box, never removed
  kIsosurface,    // put on the isosurface by R1 or R3, never removed
  kCircumcenter,  // put at a circumcentre by R2, R4 or R5; R6 may remove it ("free")
};

struct Vertex {
  Point point;
  std::uint32_t lock = 0;         // the lock word (vertex_locks.h)
  std::uint16_t local_index = 0;  // scratch of the operation that holds the lock
  VertexKind kind = VertexKind::kUnused;
};
static_assert(sizeof(Vertex) == 40 || sizeof(Vertex) == 32);

/// Everything a conflict test, a walk and a gluing read: 64 bytes, one cache line.
struct alignas(64) Cell {
  Circumsphere sphere;
  std::array<VertexId, 4> vertices{kNoVertex, kNoVertex, kNoVertex, kNoVertex};
  std::array<FacetId, 4> mirrors{};  // the facet on the other side of each of ours
  bool is_alive() const { return vertices[0] != kNoVertex; }
};
static_assert(sizeof(Cell) == 64);

inline constexpr LabelIndex kUnknownLabel = 0xffff;

struct CellState {
  std::uint16_t stamp : 15 = 0;      // changes whenever the id is reused, so that a stale list entry is seen
  std::uint16_t in_region : 1 = 0;   // scratch of the operation that holds the locks
  LabelIndex label = kUnknownLabel;  // of the image at the circumcentre, once asked for
};
static_assert(sizeof(CellState) == 4);

/// Opposite corners of the virtual box.
struct Box {
  Point low, high;
};

class Mesh {
 public:
  /// The six cells of the virtual box, all vertices kBox. Capacities bound the ids that pools may take.
  Mesh(const Box& box, std::size_t cell_capacity);

  Cell& cell(CellId c) { return cells_[c]; }
  const Cell& cell(CellId c) const { return cells_[c]; }
  CellState& state(CellId c) { return states_[c]; }
  const CellState& state(CellId c) const { return states_[c]; }
  Vertex& vertex(VertexId v) { return vertices_[v]; }
  const Vertex& vertex(VertexId v) const { return vertices_[v]; }
  const Point& point(VertexId v) const { return vertices_[v].point; }

  /// Asks for a cell's cache lines before they are needed.
  void prefetch(CellId c) const {
    __builtin_prefetch(&cells_[c]);
    __builtin_prefetch(&states_[c]);
  }

  /// Ids below these have been handed out; some may be free again.
  CellId cell_bound() const { return cell_bound_; }
  VertexId vertex_bound() const { return vertex_bound_; }
  std::size_t cell_capacity() const { return cells_.capacity(); }
  double extent() const { return extent_; }  // the largest coordinate, M of circumsphere.h
  const Box& box() const { return box_; }

  void refresh_sphere(CellId c);
  bool is_in_conflict(CellId c, const Point& p) const;  // exact, unique by perturbation
  std::uint64_t num_cells() const;

  /// Throws std::bad_alloc when the capacity is used up.
  CellId take_new_cells(std::uint32_t count);
  VertexId take_new_vertices(std::uint32_t count);

 private:
  Box box_;
  double extent_;
  HugeArray<Cell> cells_;
  HugeArray<CellState> states_;
  HugeArray<Vertex> vertices_;
  CellId cell_bound_ = 0;
  VertexId vertex_bound_ = 0;
};

/// One worker's free ids: its own dead slots first (warm in its cache), then blocks from the store.
class Pool {
 public:
  explicit Pool(Mesh& mesh) : mesh_(mesh) {}
  CellId take_cell();
  VertexId take_vertex();
  void release_cell(CellId c);
  void release_vertex(VertexId v);

 private:
  static constexpr std::uint32_t kBlock = 1024;
  Mesh& mesh_;
  std::vector<CellId> free_cells_;
  std::vector<VertexId> free_vertices_;
  CellId next_cell_ = 0, end_cell_ = 0;
  VertexId next_vertex_ = 0, end_vertex_ = 0;
};

/// Whether adjacency, orientation, circumspheres and the local Delaunay property all hold; `fault` tells what
/// does not. Linear in the number of cells.
bool is_valid(const Mesh& mesh, std::string* fault = nullptr);

}  // namespace podm
