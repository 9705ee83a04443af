// What the oracle is tested against: small images and straightforward definitions.
#pragma once

#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "geometry/point.h"
#include "isosurface/voxel_strengths.h"
#include "podm/label_image.h"

namespace podm::test {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high);

/// An image of background.
LabelImage empty_image(std::array<int, 3> size, std::array<double, 3> spacing);
/// Every voxel one of `num_labels` labels, background included; `coherence` in [0,1) is the chance that a
/// voxel copies its predecessor along a random axis.
LabelImage random_image(Random& random, std::array<int, 3> size, std::array<double, 3> spacing,
                        unsigned num_labels, double coherence);

/// As strong as chance will have it, from one voxel to the next.
std::shared_ptr<const VoxelStrengths> random_strengths(Random& random, const LabelImage& image);

struct Phantom {
  std::string name;
  LabelImage image;
};
/// A sphere, a slab, a torus, two halves of a sphere and a sphere cut by the border, voxelised.
std::vector<Phantom> smooth_phantoms();
Phantom sphere_of_long_voxels();

/// Uniform in the grid grown by `margin` voxels.
Point random_point(Random& random, const LabelImage& image, double margin);

struct ReferenceLabel {
  LabelIndex label;
  double lead;  // its weight less that of the next
};
/// The definition: weights of the eight voxels around p added up by label. `strengths` are null where all are
/// 1, here and below.
ReferenceLabel reference_label(const LabelImage& image, const Point& p,
                               const VoxelStrengths* strengths = nullptr);

/// Points of the isosurface: the label changes along lines of a lattice `per_voxel` lines a voxel. From
/// the least x on.
std::vector<Point> sample_isosurface(const LabelImage& image, int per_voxel,
                                     const VoxelStrengths* strengths = nullptr);

/// Of `points` from the least x on.
double distance_to_nearest(const std::vector<Point>& points, const Point& p);

/// Whether the label changes within `voxels` of p.
bool is_on_isosurface(const LabelImage& image, const Point& p, double voxels,
                      const VoxelStrengths* strengths = nullptr);

}  // namespace podm::test
