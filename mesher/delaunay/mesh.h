// The store of the triangulation: vertices and cells by 32-bit id, one cache line a cell.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "delaunay/id_arena.h"
#include "delaunay/lock_contract.h"
#include "delaunay/step.h"
#include "geometry/box.h"
#include "geometry/circumsphere.h"
#include "geometry/point.h"
#include "geometry/tetrahedron.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"
#include "runtime/shared_word.h"

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
static_assert(sizeof(Vertex) == 32);

/// The point as someone sees it who may not have locked the vertex: of a stale cell it may be in the middle
/// of a change. Acquire, and release in place(): who sees a coordinate of the new point sees that the cells
/// of the old one have died.
inline Point peek_point(const Vertex& v) {
  const auto peek = [](const double& coordinate) {
    step();
    return load(coordinate, std::memory_order_acquire);
  };
  return {peek(v.point.x), peek(v.point.y), peek(v.point.z)};
}
/// Makes an unused vertex one at `p`.
inline void place(Vertex& v, const Point& p, VertexKind kind) {
  store(v.point.x, p.x, std::memory_order_release);
  step();
  store(v.point.y, p.y, std::memory_order_release);
  step();
  store(v.point.z, p.z, std::memory_order_release);
  v.kind = kind;
}

inline constexpr LabelIndex kUnknownLabel = 0xffff;

/// Everything that is read of a cell, its state too: 64 bytes, one cache line.
struct alignas(64) Cell {
  Point center;                      // the circumcentre
  float squared_radius = 0;          // rounded, or NaN: circumsphere.h
  std::uint16_t stamp_and_bits = 0;  // Mesh::stamp, Mesh::is_marked and Mesh::relies_on_others
  LabelIndex label = kUnknownLabel;  // the image's at the circumcentre, once asked for
  std::array<VertexId, 4> vertices{kNoVertex, kNoVertex, kNoVertex, kNoVertex};
  std::array<FacetId, 4> mirrors{};  // the facet on the other side of each of ours
  // A cell has four vertices; memory that nobody has touched has none, nor has a cell that died.
  bool is_alive() const { return vertices[0] != vertices[1]; }
};
static_assert(sizeof(Cell) == 64);

class Mesh {
 public:
  /// The six cells of the virtual box, all vertices kBox. The capacity bounds the ids that pools may take;
  /// `num_nodes` is how many NUMA nodes they are on.
  Mesh(const Box& box, std::size_t cell_capacity, int num_nodes = 1);

  // Builds that check the lock protocol do it here: step.h, lock_contract.h.
  const Cell& cell(CellId c) const { return note_read(c), assert_may_read(*this, c), cells_[c]; }
  LabelIndex& label(CellId c) { return step(), assert_may_read(*this, c), cells_[c].label; }
  LabelIndex label(CellId c) const { return assert_may_read(*this, c), cells_[c].label; }
  Vertex& vertex(VertexId v) { return step(), vertices_[v]; }
  const Vertex& vertex(VertexId v) const { return step(), vertices_[v]; }
  const Point& point(VertexId v) const { return step(), vertices_[v].point; }

  /// Changes whenever the id is reused, so that a stale list entry is seen. Relaxed: without locks it is a
  /// guess.
  std::uint16_t stamp(CellId c) const {
    step();
    return load(cells_[c].stamp_and_bits, std::memory_order_relaxed) & kStampBits;
  }
  /// Two vertices as someone without locks sees them. Acquire, and release in renew(): who sees a vertex of
  /// the new cell sees the new stamp too.
  std::array<VertexId, 2> peek_two_vertices(CellId c) const {
    const auto& v = cells_[c].vertices;
    step();
    const VertexId last = load(v[3], std::memory_order_acquire);
    step();
    return {last, load(v[0], std::memory_order_acquire)};
  }
  /// Others that may be asked for without locks: of a cell that is being replaced the answer may be of the
  /// old cell or the new, or of neither.
  std::array<VertexId, 4> peek_vertices(CellId c) const { return peek(cells_[c].vertices); }
  std::array<FacetId, 4> peek_mirrors(CellId c) const { return peek(cells_[c].mirrors); }
  bool peek_is_alive(CellId c) const {
    const std::array<VertexId, 4> v = peek_vertices(c);
    return v[0] != v[1];
  }
  Point peek_center(CellId c) const {
    const auto peek = [](const double& coordinate) { return load(coordinate, std::memory_order_relaxed); };
    const Point& center = cells_[c].center;
    step();
    return {peek(center.x), peek(center.y), peek(center.z)};
  }
  /// The address of a cell's slot, whatever is in it.
  const void* address(CellId c) const { return &cells_[c]; }
  /// Scratch of the operation that holds the locks: the cell is in its region.
  bool is_marked(CellId c) const {
    step();
    assert_may_read(*this, c);
    return has(c, kMark);
  }
  void mark(CellId c, bool is_marked) {
    step();
    assert_may_replace(*this, c);
    put(c, kMark, is_marked);
  }
  /// Whether R1 asks the cell for nothing because of vertices that are not its own, as who examined it last
  /// told; false of a new cell.
  bool relies_on_others(CellId c) const {
    step();
    assert_may_read(*this, c);
    return has(c, kReliance);
  }
  /// By the operation that has reserved the cell, or made it.
  void tell_reliance(CellId c, bool relies_on_others) {
    step();
    assert_may_read(*this, c);
    if (has(c, kReliance) != relies_on_others) put(c, kReliance, relies_on_others);
  }
  /// Puts a new cell in the slot c, or none (vertices kNoVertex). Its sphere and mirrors are the caller's to
  /// set.
  void renew(CellId c, const std::array<VertexId, 4>& vertices) {
    Cell& cell = cells_[c];
    note_replaced(c);
    assert_may_replace(*this, c);
    step();
    store(cell.stamp_and_bits, static_cast<std::uint16_t>((cell.stamp_and_bits + 1) & kStampBits),
          std::memory_order_relaxed);
    cell.label = kUnknownLabel;
    for (unsigned i = 0; i < 4; ++i) {
      step();
      store(cell.vertices[i], vertices[i], std::memory_order_release);
    }
  }
  /// The sphere of a cell just renewed. Relaxed: who peeks at the centre may see some of the old one.
  void set_sphere(CellId c, const Circumsphere& sphere) {
    assert_may_write_mirrors(*this, c);
    Cell& cell = cells_[c];
    step();
    store(cell.center.x, sphere.center.x, std::memory_order_relaxed);
    store(cell.center.y, sphere.center.y, std::memory_order_relaxed);
    store(cell.center.z, sphere.center.z, std::memory_order_relaxed);
    cell.squared_radius = stored_squared_radius(sphere.squared_radius);
  }
  /// Those of a cell just renewed.
  void set_mirrors(CellId c, const std::array<FacetId, 4>& mirrors) {
    step();
    assert_may_write_mirrors(*this, c);
    for (unsigned i = 0; i < 4; ++i) store(cells_[c].mirrors[i], mirrors[i], std::memory_order_relaxed);
  }
  /// Puts the cell `from` in the slot `to`, its own or one without a cell, under other names of what it
  /// refers to. Nobody else may use either.
  void move_cell(CellId from, CellId to, const std::array<VertexId, 4>& vertices,
                 const std::array<FacetId, 4>& mirrors);
  /// Tells the facet `of` that `mirror` lies on its other side. Nothing is beyond the box.
  void set_mirror(FacetId of, FacetId mirror) {
    step();
    if (of == kNoFacet) return;
    assert_may_write_mirrors(*this, cell_of(of));
    store(cells_[cell_of(of)].mirrors[static_cast<unsigned>(index_in_cell(of))], mirror,
          std::memory_order_relaxed);
  }

  /// Ask for cache lines before they are needed: of a cell, of a vertex, of a cell's vertices, of its
  /// neighbours, and of both.
  void prefetch(CellId c) const { __builtin_prefetch(&cells_[c]); }
  void prefetch_vertex(VertexId v) const { __builtin_prefetch(&vertices_[v]); }
  void prefetch_vertices(CellId c) const {
    for (const VertexId v : peek_vertices(c))
      if (v != kNoVertex) prefetch_vertex(v);
  }
  void prefetch_neighbors(CellId c) const {
    for (const FacetId mirror : peek_mirrors(c))
      if (mirror != kNoFacet) prefetch(cell_of(mirror));
  }
  void prefetch_surroundings(CellId c) const {
    prefetch_vertices(c);
    prefetch_neighbors(c);
  }

  /// Ids below these have been handed out; some may be free again.
  CellId cell_bound() const { return cell_ids_.bound(); }
  VertexId vertex_bound() const { return vertex_ids_.bound(); }
  std::size_t cell_capacity() const { return cells_.capacity(); }
  double extent() const { return extent_; }  // the largest coordinate, M of circumsphere.h
  const Box& box() const { return box_; }

  void refresh_sphere(CellId c);
  /// The same, of the vertices in the order of their coordinates: so that stores which have the cell in
  /// common agree about its centre to the bit, and about its label, which has to be asked for again.
  void make_canonical(CellId c);
  bool is_in_conflict(CellId c, const Point& p) const;  // exact, unique by perturbation
  std::uint64_t num_cells() const;

  /// Give memory back while a finished mesh is taken apart. What is released is not to be asked for any more.
  void release_cells(CellId begin, CellId end) { cells_.release(begin, end); }
  void release_vertices(VertexId begin, VertexId end) { vertices_.release(begin, end); }

  /// The store is to have so many cells less than its capacity, whatever was withheld before: others need the
  /// memory. False: it has more already, and gets none any more.
  bool withhold(std::size_t cells) { return cell_ids_.withhold(cells); }
  /// Whether a cell or a vertex was wanted beyond the capacity.
  bool is_used_up() const { return cell_ids_.is_used_up() || vertex_ids_.is_used_up(); }

  /// These know which ids there are, and whose; pools take them.
  IdArena& cell_ids() { return cell_ids_; }
  IdArena& vertex_ids() { return vertex_ids_; }
  int num_nodes() const { return cell_ids_.num_nodes(); }
  /// The node whose pool handed out the id.
  NodeIndex node_of_cell(CellId c) const { return cell_ids_.node_of(c); }
  NodeIndex node_of_vertex(VertexId v) const { return vertex_ids_.node_of(v); }

 private:
  static std::array<std::uint32_t, 4> peek(const std::array<std::uint32_t, 4>& words) {
    const auto at = [&](std::size_t i) { return load(words[i], std::memory_order_relaxed); };
    return {at(0), at(1), at(2), at(3)};
  }

  Box box_;
  double extent_;
  HugeArray<Cell> cells_;
  HugeArray<Vertex> vertices_;
  // Relaxed: others who may read the cell ask at the same time.
  bool has(CellId c, std::uint16_t bit) const {
    return (load(cells_[c].stamp_and_bits, std::memory_order_relaxed) & bit) != 0;
  }
  void put(CellId c, std::uint16_t bit, bool is_set) {
    std::uint16_t& word = cells_[c].stamp_and_bits;
    store(word, static_cast<std::uint16_t>(is_set ? word | bit : word & ~bit), std::memory_order_relaxed);
  }

  static constexpr std::uint16_t kStampBits = 0x3fff, kReliance = 0x4000, kMark = 0x8000;
  IdArena cell_ids_, vertex_ids_;
};

/// Whether adjacency and orientation hold: what is left of is_valid() for an optimised mesh.
bool is_triangulation(const Mesh& mesh, std::string* fault = nullptr);
/// Whether adjacency, orientation, circumspheres and the local Delaunay property all hold; `fault` tells what
/// does not. Linear in the number of cells.
bool is_valid(const Mesh& mesh, std::string* fault = nullptr);

}  // namespace podm
