// The labels of a mesh at places of its image.
#pragma once

#include <algorithm>
#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/walk.h"
#include "geometry/affine.h"
#include "geometry/predicates.h"
#include "image/working_frame.h"
#include "podm/label_image.h"

namespace podm {

/// Walks from place to place. Places should therefore come in an order in which most are near the one before.
class LabelsAtPlaces {
 public:
  /// The mesh is Delaunay and does not change meanwhile. The label of every living cell is known.
  LabelsAtPlaces(const Mesh& mesh, const LabelImage& image)
      : mesh_(mesh), image_(image), to_working_(voxels_to_working(image)) {
    while (!mesh.cell(last_).is_alive()) ++last_;
  }
  /// The label of the cell that contains a place, which is given in voxels. If a place is on facets, it is
  /// the least label of their cells, except the background: samples are often at corners of voxels.
  LabelIndex operator()(const Point& voxels) {
    const Point p = map(to_working_, voxels);
    last_ = cell_with(mesh_, p, last_);
    around_.assign(1, last_);
    for (std::size_t i = 0; i < around_.size(); ++i) add_beyond_facets_with(p, around_[i]);
    LabelIndex least = kBackground;
    for (const CellId c : around_)
      if (const LabelIndex label = mesh_.label(c); least == kBackground || is_less(label, least))
        least = label;
    return least;
  }

 private:
  bool is_less(LabelIndex a, LabelIndex b) const {
    return a != kBackground && image_.labels[a].value < image_.labels[b].value;
  }
  void add_beyond_facets_with(const Point& p, CellId c) {
    const Cell& cell = mesh_.cell(c);
    for (unsigned k = 0; k < 4; ++k) {
      if (cell.mirrors[k] == kNoFacet) continue;
      const auto point = [&](unsigned i) {
        return mesh_.point(cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])]);
      };
      if (orientation(point(0), point(1), point(2), p) != 0) continue;
      const CellId beyond = cell_of(cell.mirrors[k]);
      if (std::ranges::find(around_, beyond) == around_.end()) around_.push_back(beyond);
    }
  }

  const Mesh& mesh_;
  const LabelImage& image_;
  const Affine to_working_;
  CellId last_ = 0;
  std::vector<CellId> around_;
};

}  // namespace podm
