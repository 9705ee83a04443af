// The labels of a mesh at places of its image.
#pragma once

#include "delaunay/mesh.h"
#include "delaunay/walk.h"
#include "geometry/affine.h"
#include "image/working_frame.h"
#include "podm/label_image.h"

namespace podm {

/// Walks from place to place. Places should therefore come in an order in which most are near the one before.
class LabelsAtPlaces {
 public:
  /// The mesh is Delaunay and does not change meanwhile. The label of every living cell is known.
  LabelsAtPlaces(const Mesh& mesh, const LabelImage& image)
      : mesh_(mesh), to_working_(voxels_to_working(image)) {
    while (!mesh.cell(last_).is_alive()) ++last_;
  }
  /// The label of the cell that contains a place, which is given in voxels.
  LabelIndex operator()(const Point& voxels) {
    last_ = cell_with(mesh_, map(to_working_, voxels), last_);
    return mesh_.label(last_);
  }

 private:
  const Mesh& mesh_;
  const Affine to_working_;
  CellId last_ = 0;
};

}  // namespace podm
