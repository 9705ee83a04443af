// References for tests of the oracle: small images and direct implementations of the definitions.
#pragma once

#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "geometry/point.h"
#include "isosurface/voxel_weights.h"
#include "podm/label_image.h"

namespace podm::test {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high);

/// An image of background only.
LabelImage empty_image(std::array<int, 3> size, std::array<double, 3> spacing);
/// Each voxel gets one of `num_labels` labels, background included. `coherence` in [0,1) is the probability
/// that a voxel copies its predecessor along a random axis.
LabelImage random_image(Random& random, std::array<int, 3> size, std::array<double, 3> spacing,
                        unsigned num_labels, double coherence);

/// Independent random weights of all voxels.
std::shared_ptr<const VoxelWeights> random_weights(Random& random, const LabelImage& image);

struct Phantom {
  std::string name;
  LabelImage image;
};
/// Voxelised shapes: spheres, a slab, a torus, two halves of a sphere and a sphere cut by the border.
std::vector<Phantom> smooth_phantoms();
Phantom sphere_of_long_voxels();

/// A uniform random point in the grid grown by `margin` voxels.
Point random_point(Random& random, const LabelImage& image, double margin);

struct ReferenceLabel {
  LabelIndex label;
  double lead;  // its weight minus the next greatest
};
/// The label by definition: adds up the weights of the eight voxels around p by label. `weights` are the
/// voxel weights, here and below; null if all are 1.
ReferenceLabel reference_label(const LabelImage& image, const Point& p,
                               const VoxelWeights* weights = nullptr);

/// Points of the isosurface: the label changes along the lines of a lattice with `per_voxel` lines per voxel.
/// Sorted by x.
std::vector<Point> sample_isosurface(const LabelImage& image, int per_voxel,
                                     const VoxelWeights* weights = nullptr);

/// `points` must be sorted by x.
double distance_to_nearest(const std::vector<Point>& points, const Point& p);

/// True if the label changes within `voxels` of p.
bool is_on_isosurface(const LabelImage& image, const Point& p, double voxels,
                      const VoxelWeights* weights = nullptr);

}  // namespace podm::test
