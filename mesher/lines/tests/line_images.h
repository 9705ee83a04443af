// Images with lines, and the label function by definition.
#pragma once

#include <array>
#include <functional>
#include <set>
#include <vector>

#include "isosurface/tests/isosurface_reference.h"
#include "isosurface/voxel_weights.h"
#include "lines/line_network.h"
#include "podm/label_image.h"

namespace podm::test {

/// An image whose voxels have the label that `label` gives their centers, in index coordinates.
LabelImage image_of(std::array<int, 3> size, std::array<double, 3> spacing, unsigned num_labels,
                    const std::function<LabelIndex(const Point&)>& label);

/// Grains around random seeds, with labels from 1 on. Seeds keep some distance from each other. With a
/// margin, voxels of the outer two layers are background.
LabelImage polycrystal(Random& random, std::array<int, 3> size, std::array<double, 3> spacing,
                       unsigned num_grains, bool has_margin);

/// Sectors around an axis through `center` along `direction`, with labels from 1 on.
LabelImage sectors(std::array<int, 3> size, unsigned num_sectors, const Point& center,
                   const Vector& direction);

/// The label function of an image, by definition.
class LabelFunction {
 public:
  LabelFunction(const LabelImage& image, const VoxelWeights* weights, bool is_box_flat)
      : image_(image), weights_(weights), is_box_flat_(is_box_flat) {}

  /// The label at a point in index coordinates. With a flat box, coordinates are clamped, so that points
  /// outside have the label of the box's nearest point.
  LabelIndex operator()(const Point& u) const;
  /// The labels at points of small spheres around a point in mm, the greatest of `radius` voxels.
  std::set<LabelIndex> labels_around(const Point& p, double radius) const;

 private:
  const LabelImage& image_;
  const VoxelWeights* weights_;
  bool is_box_flat_;
};

/// From mm to index coordinates, in images that have only spacings.
inline Point to_index(const LabelImage& image, const Point& p) {
  return {p.x / image.spacing[0], p.y / image.spacing[1], p.z / image.spacing[2]};
}

/// The distance of a point from the arcs of a network, all in mm.
double distance_to_arcs(const LineNetwork& network, const Point& p);
/// The number of arcs that end at each node.
std::vector<int> degrees(const LineNetwork& network);

}  // namespace podm::test
