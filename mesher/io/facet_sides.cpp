#include "io/facet_sides.h"

#include <algorithm>
#include <array>

#include "io/grouping.h"
#include "podm/errors.h"

namespace podm {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

Triangle sorted(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

// Finds the facet with three given vertices among the facets with the same lowest vertex.
class FacetFinder {
 public:
  explicit FacetFinder(const TetMesh& mesh)
      : mesh_(mesh),
        has_facet_(mesh.vertices.size()),
        by_lowest_(mesh.facets.size(), mesh.vertices.size(), [&](std::size_t i) {
          return *std::min_element(mesh.facets[i].begin(), mesh.facets[i].end());
        }) {
    for (const Triangle& facet : mesh.facets)
      for (const std::uint32_t vertex : facet) has_facet_[vertex] = 1;
  }

  // Returns false for most triangles: most cells have at most one vertex that is on a facet.
  bool may_be_facet(const Triangle& t) const {
    return has_facet_[t[0]] & has_facet_[t[1]] & has_facet_[t[2]];
  }

  template <class Visit>
  void for_each(const Triangle& triangle, const Visit& visit) const {
    const Triangle wanted = sorted(triangle);
    for (const std::uint32_t facet : by_lowest_[wanted[0]])
      if (sorted(mesh_.facets[facet]) == wanted) visit(facet);
  }

 private:
  const TetMesh& mesh_;
  std::vector<std::uint8_t> has_facet_;
  Grouping by_lowest_;
};

}  // namespace

std::vector<FacetSide> find_facet_sides(const TetMesh& mesh) {
  const FacetFinder facets(mesh);
  std::vector<FacetSide> sides(mesh.facets.size());
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto& [a, b, c, d] = mesh.cells[i];
    const std::array<Triangle, 4> triangles{{{b, c, d}, {a, c, d}, {a, b, d}, {a, b, c}}};
    for (std::uint32_t opposite = 0; opposite < 4; ++opposite) {
      if (!facets.may_be_facet(triangles[opposite])) continue;
      facets.for_each(triangles[opposite], [&](std::uint32_t facet) {
        if (mesh.facet_labels[facet][1] == mesh.cell_labels[i])
          sides[facet] = {static_cast<std::uint32_t>(i), opposite};
      });
    }
  }
  for (const FacetSide& side : sides)
    if (side.cell == FacetSide::kNoCell) throw InternalError("a facet has no cell of its second label");
  return sides;
}

}  // namespace podm
