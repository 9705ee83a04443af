#include "run/facets_of_sides.h"

#include <atomic>

#include "geometry/tetrahedron.h"
#include "image/working_frame.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr std::size_t kCellsAtOnce = 1 << 11;

SideMask common_sides(const Mesh& mesh, const Cell& cell, unsigned facet) {
  unsigned common = ~0u;
  for (const int i : kFacetVertices[facet])
    common &= mesh.vertex(cell.vertices[static_cast<unsigned>(i)]).sides;
  return static_cast<SideMask>(common);
}

// Each facet at a side has one cell with its center in the box.
std::uint64_t facets_off_sides(const Mesh& mesh, const Isosurface& isosurface, CellId c) {
  const Cell& cell = mesh.cell(c);
  std::uint64_t count = 0;
  if (!cell.is_alive() || !isosurface.box()->contains(cell.center)) return count;
  for (unsigned k = 0; k < 4; ++k) {
    if (cell.mirrors[k] == kNoFacet) continue;
    const Point& across = mesh.cell(cell_of(cell.mirrors[k])).center;
    const auto z = isosurface.exit_through_side(cell.center, across);
    count += z && (z->sides & common_sides(mesh, cell, k)) == 0;
  }
  return count;
}

}  // namespace

std::uint64_t count_facets_off_sides(const Mesh& mesh, const Isosurface& isosurface, int threads) {
  std::atomic<std::uint64_t> total = 0;
  if (!isosurface.box()) return total;
  parallel_for_ranges(mesh.cell_bound(), kCellsAtOnce, num_threads(threads),
                      [&](std::size_t begin, std::size_t end, std::size_t) {
                        std::uint64_t count = 0;
                        for (std::size_t c = begin; c < end; ++c)
                          count += facets_off_sides(mesh, isosurface, static_cast<CellId>(c));
                        total += count;
                      });
  return total;
}

bool is_turned_for_output(const LabelImage& image) {
  constexpr Affine kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  return image.is_box_flat && working_to_world(image) != kIdentity;
}

std::array<std::uint64_t, kNumSides> count_facets_of_sides(const TetMesh& mesh) {
  std::array<std::uint64_t, kNumSides> counts{};
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (std::size_t side = 0; side < kNumSides; ++side) counts[side] += side_of_facet(mesh, f) >> side & 1;
  return counts;
}

}  // namespace podm
