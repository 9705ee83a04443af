#include "io/labelled_facets.h"

#include <algorithm>
#include <span>

#include "io/grouping.h"

namespace podm {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Returns the face of a cell without its vertex `opposite`; the normal points out of the cell.
Triangle face_of(const std::array<std::uint32_t, 4>& cell, std::size_t opposite) {
  const auto& [a, b, c, d] = cell;
  return std::array<Triangle, 4>{{{b, c, d}, {a, d, c}, {a, b, d}, {a, c, b}}}[opposite];
}

// One of the four faces of a cell, ordered by its sorted vertices.
struct Face {
  Triangle sorted;
  std::uint32_t number;  // 4 * cell + opposite
  bool operator<(const Face& other) const { return sorted < other.sorted; }
};

class FacetCollector {
 public:
  explicit FacetCollector(TetMesh& mesh) : mesh_(mesh) {
    mesh.facets.clear();
    mesh.facet_labels.clear();
  }

  // `alike` are the one or two faces with the same vertices.
  void add(std::span<const Face> alike) {
    std::uint32_t behind = alike[0].number;
    std::array<LabelIndex, 2> labels{kBackground, label(behind)};
    if (alike.size() == 2) {
      labels[0] = label(alike[1].number);
      if (labels[0] == labels[1]) return;
      if (labels[0] > labels[1]) {
        std::swap(labels[0], labels[1]);
        behind = alike[1].number;
      }
    }
    mesh_.facets.push_back(face_of(mesh_.cells[behind / 4], behind % 4));
    mesh_.facet_labels.push_back(labels);
  }

 private:
  LabelIndex label(std::uint32_t face) const { return mesh_.cell_labels[face / 4]; }
  TetMesh& mesh_;
};

}  // namespace

std::optional<Triangle> find_labelled_facets(TetMesh& mesh) {
  const auto sorted_face = [&mesh](std::uint32_t face) {
    Triangle triangle = face_of(mesh.cells[face / 4], face % 4);
    std::sort(triangle.begin(), triangle.end());
    return triangle;
  };
  const Grouping by_lowest(4 * mesh.cells.size(), mesh.vertices.size(), [&](std::size_t face) {
    return sorted_face(static_cast<std::uint32_t>(face))[0];
  });
  FacetCollector collector(mesh);
  std::vector<Face> faces;  // faces with the same lowest vertex
  for (std::size_t lowest = 0; lowest < mesh.vertices.size(); ++lowest) {
    faces.clear();
    for (const std::uint32_t face : by_lowest[lowest]) faces.push_back({sorted_face(face), face});
    std::stable_sort(faces.begin(), faces.end());
    for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
      while (end < faces.size() && faces[end].sorted == faces[begin].sorted) ++end;
      if (end - begin > 2) return faces[begin].sorted;
      collector.add({&faces[begin], end - begin});
    }
  }
  return std::nullopt;
}

}  // namespace podm
