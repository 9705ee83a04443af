#include "distributed/completion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "distributed/zone.h"
#include "runtime/parallel_collect.h"

namespace podm {

namespace {

// Returns the given cells and their neighbours, each once.
std::vector<CellId> around(const Mesh& mesh, const std::vector<CellId>& some,
                           const std::vector<CellId>& more) {
  std::vector<std::uint8_t> is_listed(mesh.cell_bound());
  std::vector<CellId> cells;
  const auto list = [&](CellId c) {
    if (std::exchange(is_listed[c], 1) == 0) cells.push_back(c);
  };
  for (const CellId c : some) list(c);
  for (const CellId c : more) list(c);
  const std::size_t num_listed = cells.size();
  for (std::size_t i = 0; i < num_listed; ++i) {
    if (!mesh.cell(cells[i]).is_alive()) continue;
    for (const FacetId mirror : mesh.cell(cells[i]).mirrors)
      if (mirror != kNoFacet) list(cell_of(mirror));
  }
  return cells;
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
void insert_largest(const std::vector<CellId>& cells, const Mesh& mesh, CubeSet& wanted) {
  std::map<CubeId, CellId> largest;
  const auto is_larger = [&](CellId a, CellId b) {  // a cell without a certified sphere is larger than all
    const float of_a = mesh.cell(a).squared_radius, of_b = mesh.cell(b).squared_radius;
    return !std::isnan(of_b) && !(of_a <= of_b);
  };
  for (const CellId c : cells) {
    CellId& here = largest.emplace(wanted.grid().cube_at(mesh.cell(c).center), c).first->second;
    if (is_larger(c, here)) here = c;
  }
  for (const auto& [cube, c] : largest) Zone::insert_ball(mesh.cell(c), wanted);
}

}  // namespace

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
    insert_largest(unknown, mesh, wanted);
    std::array<std::uint64_t, 1> more{unknown.size()};
    ranks.sum(more);
    if (more[0] == 0) return sum;
    std::vector<CellId> made;
    sum += source.update(wanted, &made);
    candidates = around(mesh, made, unknown);
  }
}

}  // namespace podm
