// The store of the triangulation: vertices and cells by 32-bit id, one cache line per cell.
//
// A cell's word (Cell::stamp_and_bits) holds the stamp, the mark, the reliance and the passing facets. A
// writer loads the word, changes its own bits and stores the word. The store would undo a change that another
// worker made after the load.
//
// Proposition: no two workers write the word of a cell at the same time, and each writer loads what the last
// one stored. Proof:
//   1. set_relies_on_others() and add_facets_passing_r3() write for the worker that has reserved the cell. It
//      holds the cell's vertices 0 and 3 (lock_to_read.h).
//   2. set_mirror() writes for a worker that holds the three vertices of the facet (vertex_locks.h).
//   3. mark() and renew() write for a worker that holds all four vertices. The worker that made a cell holds
//      three or four of its vertices, as the inserted vertex is not locked. It may write anything.
//   4. Any two of these sets have a vertex in common. Two reservations hold the same two vertices, because a
//      living cell keeps the order of its vertices. Three of four vertices include vertex 0 or 3, and two
//      vertices of any other three. A lock has one holder, and passes on all that its last holder wrote.
//   5. A slot without a living cell belongs to its pool, and a reservation of it fails.
// Two vertices other than 0 and 3 do not suffice: those of another reservation could be the remaining two.
// Operation::reach() locks vertices 0 and 1, and its caller only reads. Vertices that no other worker can
// reach count as held (algorithms/leaf_locks.h). Ranks have a store each, so a zone only adds conditions
// (distributed/zone.h). With NoLocks a store has one worker at a time.
//
// A worker that has reserved a cell reads the passing facets of its neighbours while other workers may write
// them. It needs only the bit of the common facet. The maker of the reserved cell has cleared that bit in
// set_mirror(). A worker that sets the bit later has tested the facet with both cells that it has now,
// because it holds one of the facet's vertices while it tests and writes. If the reader misses the bit, it
// tests the facet again.
//
// A reservation takes a stamp for a cell's name, but stamps repeat after 1024 renewals of the slot. It
// therefore also compares the vertices that it has locked (lock_to_read.h). A cell with the same stamp and
// the same two vertices is alive and locked: it may be read as well as the one that was listed. Tests:
// WordOfCell and PassingFacets (test_word_of_cell.cpp), Refined (algorithms/tests/test_refinement.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "delaunay/id_arena.h"
#include "delaunay/lock_contract.h"
#include "delaunay/planted_fault.h"
#include "delaunay/step.h"
#include "geometry/box.h"
#include "geometry/circumsphere.h"
#include "geometry/point.h"
#include "geometry/tetrahedron.h"
#include "podm/box_sides.h"
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

/// A set of a cell's facets, one bit per local index.
using FacetMask = unsigned;
inline constexpr FacetMask kAllFacets = 0xf;

enum class VertexKind : std::uint8_t {
  kUnused,
  kBox,           // corner of the virtual box, never removed
  kIsosurface,    // placed on the isosurface by R1 or R3, never removed
  kCircumcenter,  // placed at a circumcenter by R2, R4 or R5; R6 may remove it ("free")
  kPinned,        // placed on a line that the mesh has lost there, otherwise as kIsosurface; never moved
  kLine = 0x80,   // placed on a line where three or more labels meet, never removed or moved
};
/// True for vertices on the isosurface, those on lines among them. These kinds are even, and the other kinds
/// that living cells have are odd.
constexpr bool is_on_isosurface(VertexKind kind) { return (static_cast<unsigned>(kind) & 1) == 0; }

struct Vertex {
  Point point;
  std::uint32_t lock = 0;         // the lock word (vertex_locks.h)
  std::uint16_t local_index = 0;  // scratch of the operation that holds the lock
  VertexKind kind = VertexKind::kUnused;
  /// The sides of a flat box that an isosurface vertex is on. These bits decide, never its coordinates.
  SideMask sides = 0;
};
static_assert(sizeof(Vertex) == 32);

/// Returns the point of a vertex that the caller may not have locked. The vertex of a stale cell may be in
/// the middle of a change. Acquire here and release in place(): a reader that sees a coordinate of the new
/// point also sees that the cells of the old point have died.
inline Point peek_point(const Vertex& v) {
  const auto peek = [](const double& coordinate) {
    step();
    return load(coordinate, order_of(OrderedAccess::kPeekPoint, std::memory_order_acquire));
  };
  return {peek(v.point.x), peek(v.point.y), peek(v.point.z)};
}
/// Turns an unused vertex into one at `p`.
inline void place(Vertex& v, const Point& p, VertexKind kind, SideMask sides = 0) {
  const std::memory_order release = order_of(OrderedAccess::kPlace, std::memory_order_release);
  store(v.point.x, p.x, release);
  step();
  store(v.point.y, p.y, release);
  step();
  store(v.point.z, p.z, release);
  v.kind = kind;
  v.sides = sides;
}

inline constexpr LabelIndex kUnknownLabel = 0xffff;

/// All data that is read of a cell, with its state: 64 bytes, one cache line.
struct alignas(64) Cell {
  Point center;                      // the circumcenter
  float squared_radius = 0;          // rounded, or NaN: circumsphere.h
  std::uint16_t stamp_and_bits = 0;  // Mesh::stamp, is_marked, relies_on_others and facets_passing_r3
  LabelIndex label = kUnknownLabel;  // the image's label at the circumcenter, once looked up
  std::array<VertexId, 4> vertices{kNoVertex, kNoVertex, kNoVertex, kNoVertex};
  std::array<FacetId, 4> mirrors{};  // per facet, the mirror facet on its other side
  // A living cell has four distinct vertices. Untouched memory and dead cells have equal ones.
  bool is_alive() const { return vertices[0] != vertices[1]; }
  bool has(VertexId v) const {
    return vertices[0] == v || vertices[1] == v || vertices[2] == v || vertices[3] == v;
  }
};
static_assert(sizeof(Cell) == 64);

class Mesh {
 public:
  /// Makes the six cells of the virtual box, all vertices kBox. The capacity bounds the ids that pools may
  /// take. `num_nodes` is the number of NUMA nodes that the pools are on. Stores that share cells, if any,
  /// take their ids of cells from them.
  Mesh(const Box& box, std::size_t cell_capacity, int num_nodes = 1, SharedIds* shared_cells = nullptr);

  // Builds that check the lock protocol do so in these functions: step.h, lock_contract.h.
  const Cell& cell(CellId c) const { return note_read(c), assert_may_read(*this, c), cells_[c]; }
  LabelIndex& label(CellId c) { return step(), assert_may_read(*this, c), cells_[c].label; }
  LabelIndex label(CellId c) const { return assert_may_read(*this, c), cells_[c].label; }
  Vertex& vertex(VertexId v) { return step(), vertices_[v]; }
  const Vertex& vertex(VertexId v) const { return step(), vertices_[v]; }
  const Point& point(VertexId v) const { return step(), vertices_[v].point; }

  /// Changes whenever the id is reused, which exposes stale list entries. Relaxed: without locks the stamp is
  /// a guess.
  std::uint16_t stamp(CellId c) const {
    step();
    return load(cells_[c].stamp_and_bits, std::memory_order_relaxed) & kStampBits;
  }
  /// Returns two vertices for a caller without locks. Acquire here and release in renew(): a reader that sees
  /// a vertex of the new cell also sees the new stamp.
  std::array<VertexId, 2> peek_two_vertices(CellId c) const {
    const auto& v = cells_[c].vertices;
    const std::memory_order acquire = order_of(OrderedAccess::kPeekCell, std::memory_order_acquire);
    step();
    const VertexId last = load(v[3], acquire);
    step();
    return {last, load(v[0], acquire)};
  }
  /// Return more data to callers without locks. If the cell is being replaced, the answer may belong to the
  /// old cell, to the new cell or to neither.
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
  /// Returns the address of a cell's slot, whether or not a cell is in it.
  const void* address(CellId c) const { return &cells_[c]; }
  /// True if the cell is in the region of the operation that holds the locks; scratch of that operation.
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
  /// True if only vertices of other cells may cover the cell's R1 sample (Examination::relies_on_others), as
  /// set at the last examination. False for a new cell.
  bool relies_on_others(CellId c) const {
    step();
    assert_may_read(*this, c);
    return has(c, kReliance);
  }
  /// Sets relies_on_others(). The caller has reserved the cell or made it.
  void set_relies_on_others(CellId c, bool relies_on_others) {
    step();
    assert_may_read(*this, c);
    if (has(c, kReliance) != relies_on_others) put(c, kReliance, relies_on_others);
  }
  /// The facets, one bit per local index, to which R3 did not apply when it was tested on them from this
  /// cell. The other cell of such a facet is still the same. Empty for a new cell.
  FacetMask facets_passing_r3(CellId c) const {
    step();
    assert_may_read(*this, c);
    return load(cells_[c].stamp_and_bits, std::memory_order_relaxed) >> kFirstPassing & kAllFacets;
  }
  /// Adds to facets_passing_r3(). The caller has reserved the cell.
  void add_facets_passing_r3(CellId c, FacetMask facets) {
    step();
    assert_may_read(*this, c);
    put(c, static_cast<std::uint16_t>(facets << kFirstPassing), true);
  }
  /// Empties facets_passing_r3(), while no worker runs.
  void forget_facets_passing_r3(CellId c) {
    put(c, static_cast<std::uint16_t>(kAllFacets << kFirstPassing), false);
  }
  /// Puts a new cell in the slot c, or none (vertices kNoVertex). The caller sets its sphere and mirrors.
  void renew(CellId c, const std::array<VertexId, 4>& vertices) {
    Cell& cell = cells_[c];
    note_replaced(c);
    assert_may_replace(*this, c);
    step();
    store(cell.stamp_and_bits, static_cast<std::uint16_t>((cell.stamp_and_bits + 1) & kStampBits),
          std::memory_order_relaxed);
    cell.label = kUnknownLabel;
    for_each_index([&](unsigned i) {
      step();
      store(cell.vertices[i], vertices[i], order_of(OrderedAccess::kRenew, std::memory_order_release));
    });
  }
  /// Sets the sphere of a cell just renewed. Relaxed: peek_center() may return a part of the old center.
  void set_sphere(CellId c, const Circumsphere& sphere) {
    assert_may_write_mirrors(*this, c);
    Cell& cell = cells_[c];
    step();
    store(cell.center.x, sphere.center.x, std::memory_order_relaxed);
    store(cell.center.y, sphere.center.y, std::memory_order_relaxed);
    store(cell.center.z, sphere.center.z, std::memory_order_relaxed);
    cell.squared_radius = stored_squared_radius(sphere.squared_radius);
  }
  /// Sets the mirrors of a cell just renewed.
  void set_mirrors(CellId c, const std::array<FacetId, 4>& mirrors) {
    step();
    assert_may_write_mirrors(*this, c);
    for_each_index([&](unsigned i) { store(cells_[c].mirrors[i], mirrors[i], std::memory_order_relaxed); });
  }
  /// Moves the cell in the slot `from` to the slot `to`, which is the same slot or holds no cell, with new
  /// ids of its vertices and mirrors. No other worker may use either slot.
  void move_cell(CellId from, CellId to, const std::array<VertexId, 4>& vertices,
                 const std::array<FacetId, 4>& mirrors);
  /// Records that `mirror` is the other side of the facet `of`, whose dual edge changes. Does nothing beyond
  /// the box.
  void set_mirror(FacetId of, FacetId mirror) {
    step();
    if (of == kNoFacet) return;
    assert_may_write_mirrors(*this, cell_of(of));
    store(cells_[cell_of(of)].mirrors[static_cast<unsigned>(index_in_cell(of))], mirror,
          std::memory_order_relaxed);
    put(cell_of(of), static_cast<std::uint16_t>(1u << (kFirstPassing + index_in_cell(of))), false);
  }

  /// Prefetch cache lines: of a cell, of a vertex, of a cell's vertices, of its neighbours, and of vertices
  /// and neighbours.
  void prefetch(CellId c) const { __builtin_prefetch(&cells_[c]); }
  void prefetch_vertex(VertexId v) const { __builtin_prefetch(&vertices_[v]); }
  void prefetch_vertices(CellId c) const {
    for (const VertexId v : peek_vertices(c))
      if (v != kNoVertex) prefetch_vertex(v);
  }
  [[gnu::always_inline]] void prefetch_neighbors(CellId c) const {
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
  std::size_t vertex_capacity() const { return vertices_.capacity(); }
  double extent() const { return extent_; }  // the largest absolute coordinate, M of circumsphere.h
  const Box& box() const { return box_; }

  void refresh_sphere(CellId c);
  /// Recomputes the sphere from the vertices in the order of their coordinates. Stores that share the cell
  /// then agree about its center to the bit, and therefore about its label. Resets the label, which has to be
  /// looked up again.
  void make_canonical(CellId c);
  bool is_in_conflict(CellId c, const Point& p) const;  // exact, unique by perturbation
  std::uint64_t num_cells() const;

  /// Give memory back while a finished mesh is taken apart. The caller must not access released items again.
  void release_cells(CellId begin, CellId end) { cells_.release(begin, end); }
  void release_vertices(VertexId begin, VertexId end) { vertices_.release(begin, end); }

  /// Reduces the capacity by `cells` and replaces any earlier reduction, because other data needs the memory.
  /// Returns false if the store already holds more; it then gets no more ids.
  bool reduce_capacity(std::size_t cells) { return cell_ids_.reduce_capacity(cells); }
  /// True if a cell or a vertex was requested beyond the capacity.
  bool is_exhausted() const { return cell_ids_.is_exhausted() || vertex_ids_.is_exhausted(); }

  /// The arenas that know which ids exist and which node owns them. Pools take ids from them.
  IdArena& cell_ids() { return cell_ids_; }
  IdArena& vertex_ids() { return vertex_ids_; }
  int num_nodes() const { return cell_ids_.num_nodes(); }
  /// Returns the node whose pool handed out the id.
  NodeIndex node_of_cell(CellId c) const { return cell_ids_.node_of(c); }
  NodeIndex node_of_vertex(VertexId v) const { return vertex_ids_.node_of(v); }

 private:
  // Calls visit(index) for the four local indices. Compilers keep a loop here, with its values in memory.
  template <class Visit>
  static void for_each_index(const Visit& visit) {
    visit(0), visit(1), visit(2), visit(3);
  }
  static std::array<std::uint32_t, 4> peek(const std::array<std::uint32_t, 4>& words) {
    const auto at = [&](std::size_t i) { return load(words[i], std::memory_order_relaxed); };
    return {at(0), at(1), at(2), at(3)};
  }

  Box box_;
  double extent_;
  HugeArray<Cell> cells_;
  HugeArray<Vertex> vertices_;
  // Relaxed: other workers that may read the cell call this at the same time.
  bool has(CellId c, std::uint16_t bit) const {
    return (load(cells_[c].stamp_and_bits, std::memory_order_relaxed) & bit) != 0;
  }
  void put(CellId c, std::uint16_t bits, bool are_set) {
    std::uint16_t& word = cells_[c].stamp_and_bits;
    store(word, static_cast<std::uint16_t>(are_set ? word | bits : word & ~bits), std::memory_order_relaxed);
  }

  static constexpr std::uint16_t kStampBits = 0x3ff, kReliance = 0x4000, kMark = 0x8000;
  static constexpr int kFirstPassing = 10;
  IdArena cell_ids_, vertex_ids_;
};

}  // namespace podm
