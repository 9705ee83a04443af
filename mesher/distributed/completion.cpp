#include "distributed/completion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "distributed/cell_marks.h"
#include "distributed/zone.h"
#include "runtime/parallel_collect.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

// Returns the cells of the two lists and their neighbours, each once.
std::vector<CellId> around(const Mesh& mesh, const std::vector<CellId>& some, const std::vector<CellId>& more,
                           std::size_t threads) {
  constexpr std::size_t kLength = 1 << 12;
  CellMarks marks(mesh.cell_bound());
  for (const auto* const list : {&some, &more})
    parallel_for_ranges(list->size(), kLength, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i)
        if (const CellId c = (*list)[i]; mesh.cell(c).is_alive()) marks.mark_with_neighbors(c, mesh);
    });
  return marks.cells(threads);
}

// Returns those of the given cells (unset: of all cells) that have a vertex in the zone but may not be cells
// of the whole mesh. Neighbours of cells with a vertex in the zone are included.
std::vector<CellId> unknown_among(const std::optional<std::vector<CellId>>& cells, const Mesh& mesh,
                                  const Zone& zone, std::size_t threads) {
  const auto is_in_zone = [&](VertexId v) {
    return mesh.vertex(v).kind != VertexKind::kBox && zone.has(mesh.point(v));
  };
  const auto check = [&](CellId c, std::vector<CellId>& unknown) {
    const Cell& cell = mesh.cell(c);
    if (!cell.is_alive()) return;
    const auto num_in_zone = std::count_if(cell.vertices.begin(), cell.vertices.end(), is_in_zone);
    if (num_in_zone == 0) return;
    if (!zone.knows(cell)) unknown.push_back(c);
    // Its neighbours have vertices in the zone, too, and are checked as cells of their own.
    if (num_in_zone == 4) return;
    for (const FacetId mirror : cell.mirrors)
      if (mirror != kNoFacet && !zone.knows_beside(cell, mesh.cell(cell_of(mirror))))
        unknown.push_back(cell_of(mirror));
  };
  return parallel_collect<CellId>(cells ? cells->size() : mesh.cell_bound(), threads,
                                  [&](std::size_t begin, std::size_t end, std::vector<CellId>& unknown) {
                                    for (std::size_t i = begin; i < end; ++i)
                                      check(cells ? (*cells)[i] : static_cast<CellId>(i), unknown);
                                  });
}

// Inserts, for each cube, the largest of the balls centered in it. The other balls hardly reach farther, and
// a cell that still lacks a vertex is unknown in the next iteration.
void insert_largest(const std::vector<CellId>& cells, const Mesh& mesh, std::size_t threads,
                    CubeSet& wanted) {
  struct InCube {
    CubeId cube;
    CellId cell;
  };
  auto by_cube = parallel_collect<InCube>(
      cells.size(), threads, [&](std::size_t begin, std::size_t end, std::vector<InCube>& found) {
        for (std::size_t i = begin; i < end; ++i)
          found.push_back({wanted.grid().cube_at(mesh.cell(cells[i]).center), cells[i]});
      });
  // A cell without a certified sphere is larger than all others.
  const auto radius_of = [&](const InCube& one) {
    const float squared = mesh.cell(one.cell).squared_radius;
    return std::isnan(squared) ? std::numeric_limits<float>::infinity() : squared;
  };
  parallel_sort(by_cube.begin(), by_cube.end(), threads, [&](const InCube& a, const InCube& b) {
    return a.cube != b.cube ? a.cube < b.cube : radius_of(a) > radius_of(b);
  });
  for (std::size_t i = 0; i < by_cube.size(); ++i)
    if (i == 0 || by_cube[i].cube != by_cube[i - 1].cube)
      Zone::insert_ball(mesh.cell(by_cube[i].cell), wanted);
}

}  // namespace

// No ring of cubes around the block is taken to be known, so that every ball is looked at.
std::vector<CellId> unknown_cells(const Mesh& mesh, const CubeSet& own, const CubeSet& known,
                                  std::size_t threads) {
  return unknown_among({}, mesh, Zone(own, known, 0), threads);
}

// Each iteration except the first looks only at the cells that changed and at those that were unknown. In
// every iteration except the last, some rank requests a largest ball that it lacks, and therefore a new cube.
// The number of cubes is finite, so the iterations end.
Update complete(const Mesh& mesh, VertexSource& source, const CubeSet& own, int rings, std::size_t threads,
                Communication& ranks) {
  CubeSet wanted = own.grown(rings);
  Update sum = source.update(wanted, nullptr);
  std::optional<std::vector<CellId>> candidates;  // unset: all cells
  for (;;) {
    const Zone zone(own, source.known(), rings);
    const std::vector<CellId> unknown = unknown_among(candidates, mesh, zone, threads);
    insert_largest(unknown, mesh, threads, wanted);
    std::array<std::uint64_t, 1> more{unknown.size()};
    ranks.sum(more);
    if (more[0] == 0) return sum;
    std::vector<CellId> made;
    sum += source.update(wanted, &made);
    candidates = around(mesh, made, unknown, threads);
  }
}

}  // namespace podm
