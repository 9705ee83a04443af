#include "isosurface_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>

namespace podm::test {

namespace {

// An image whose voxels have the label that `label` gives their centers. Centers are relative to the grid's
// center, in mm.
LabelImage voxelised(std::array<int, 3> size, std::array<double, 3> spacing,
                     const std::function<LabelIndex(const Point&)>& label) {
  LabelImage image = empty_image(size, spacing);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        image.voxels[image.index(i, j, k)] =
            label({(i - 0.5 * (size[0] - 1)) * spacing[0], (j - 0.5 * (size[1] - 1)) * spacing[1],
                   (k - 0.5 * (size[2] - 1)) * spacing[2]});
  return image;
}

LabelIndex label_of_voxel(const LabelImage& image, int i, int j, int k) {
  const bool is_in =
      i >= 0 && j >= 0 && k >= 0 && i < image.size[0] && j < image.size[1] && k < image.size[2];
  return is_in ? image.voxels[image.index(i, j, k)] : kBackground;
}

}  // namespace

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

LabelImage empty_image(std::array<int, 3> size, std::array<double, 3> spacing) {
  LabelImage image;
  image.size = size;
  image.spacing = spacing;
  image.voxel_to_ras = {spacing[0], 0, 0, 0, 0, spacing[1], 0, 0, 0, 0, spacing[2], 0};
  image.voxels.assign(image.num_voxels(), kBackground);
  return image;
}

LabelImage random_image(Random& random, std::array<int, 3> size, std::array<double, 3> spacing,
                        unsigned num_labels, double coherence) {
  LabelImage image = empty_image(size, spacing);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        LabelIndex label = static_cast<LabelIndex>(random() % num_labels);
        if (uniform(random, 0, 1) < coherence) {
          const auto axis = random() % 3;
          label = label_of_voxel(image, i - (axis == 0), j - (axis == 1), k - (axis == 2));
        }
        image.voxels[image.index(i, j, k)] = label;
      }
  return image;
}

std::shared_ptr<const VoxelWeights> random_weights(Random& random, const LabelImage& image) {
  auto weights = std::make_shared<VoxelWeights>(image.size);
  for (std::size_t v = 0; v < image.num_voxels(); ++v)
    weights->at(v) = static_cast<std::uint16_t>(1 + random() % VoxelWeights::kMost);
  return weights;
}

std::vector<Phantom> smooth_phantoms() {
  const auto radius = [](const Point& p) { return std::sqrt(squared_length(p)); };
  return {
      {"sphere",
       voxelised({24, 25, 22}, {1, 1, 1}, [&](const Point& p) { return LabelIndex(radius(p) < 8.3); })},
      {"flat sphere",
       voxelised({26, 26, 15}, {0.6, 0.6, 1.4}, [&](const Point& p) { return LabelIndex(radius(p) < 6.1); })},
      {"slab", voxelised({18, 14, 12}, {1, 0.7, 1.3},
                         [](const Point& p) { return LabelIndex(std::fabs(p.x + 0.4 * p.y) < 3.2); })},
      {"torus", voxelised({30, 30, 12}, {1, 1, 1.2},
                          [](const Point& p) {
                            const double to_axis = std::hypot(p.x, p.y) - 8.5;
                            return LabelIndex(std::hypot(to_axis, p.z) < 3.6);
                          })},
      {"two halves", voxelised({24, 24, 24}, {1, 1, 1},
                               [&](const Point& p) {
                                 return LabelIndex(radius(p) < 9.2 ? (p.x + 0.3 * p.z < 0.2 ? 1 : 2) : 0);
                               })},
      {"cut sphere",
       voxelised({16, 24, 24}, {1, 1, 1}, [&](const Point& p) { return LabelIndex(radius(p) < 9.6); })},
  };
}

Phantom sphere_of_long_voxels() {
  return {"sphere of long voxels", voxelised({26, 26, 7}, {1, 1, 5}, [&](const Point& p) {
            return LabelIndex(std::sqrt(squared_length(p)) < 10.1);
          })};
}

Point random_point(Random& random, const LabelImage& image, double margin) {
  const auto along = [&](std::size_t a) {
    return uniform(random, -0.5 - margin, image.size[a] - 0.5 + margin) * image.spacing[a];
  };
  const double x = along(0), y = along(1), z = along(2);
  return {x, y, z};
}

ReferenceLabel reference_label(const LabelImage& image, const Point& p, const VoxelWeights* voxel_weights) {
  const std::array<double, 3> u = {p.x / image.spacing[0], p.y / image.spacing[1], p.z / image.spacing[2]};
  std::array<int, 3> base;
  std::array<double, 3> f;
  for (std::size_t a = 0; a < 3; ++a) {
    base[a] = static_cast<int>(std::floor(u[a]));
    f[a] = u[a] - base[a];
  }
  std::map<LabelIndex, double> weights;
  for (int c = 0; c < 8; ++c) {
    const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
    const Voxel v{base[0] + i, base[1] + j, base[2] + k};
    weights[label_of_voxel(image, v.i, v.j, v.k)] +=
        (voxel_weights != nullptr ? voxel_weights->weight(v) : 1) * (i ? f[0] : 1 - f[0]) *
        (j ? f[1] : 1 - f[1]) * (k ? f[2] : 1 - f[2]);
  }
  ReferenceLabel best{0, -1};
  double weight = -1, next = 0;
  for (const auto& [label, w] : weights) {
    if (w > weight) {
      next = std::max(next, weight);
      weight = w;
      best.label = label;
    } else {
      next = std::max(next, w);
    }
  }
  best.lead = weight - next;
  return best;
}

std::vector<Point> sample_isosurface(const LabelImage& image, int per_voxel, const VoxelWeights* weights) {
  using Place = std::array<int, 3>;  // in the lattice
  const auto label = [&](const Point& p) { return reference_label(image, p, weights).label; };
  // The lattice avoids voxel centers, where its lines would lie in block faces.
  const auto coordinate = [&](const Place& n, std::size_t axis) {
    return (-1 + (n[axis] + 0.37) / per_voxel) * image.spacing[axis];
  };
  const auto point = [&](const Place& n) {
    return Point{coordinate(n, 0), coordinate(n, 1), coordinate(n, 2)};
  };
  std::vector<Place> lattice;
  std::vector<LabelIndex> labels;
  const auto count = [&](std::size_t axis) { return (image.size[axis] + 1) * per_voxel + 1; };
  for (int i = 0; i < count(0); ++i)
    for (int j = 0; j < count(1); ++j)
      for (int k = 0; k < count(2); ++k) {
        lattice.push_back({i, j, k});
        labels.push_back(label(point(lattice.back())));
      }
  std::vector<Point> points;
  const auto add_change = [&](Point low, Point high, LabelIndex of_low) {
    for (int i = 0; i < 40; ++i) {
      const Point middle = 0.5 * (low + high);
      (label(middle) == of_low ? low : high) = middle;
    }
    points.push_back(low);
  };
  for (std::size_t at = 0; at < lattice.size(); ++at) {
    std::size_t step = 1;  // to the next point along the axis
    for (const std::size_t axis : {2, 1, 0}) {
      if (lattice[at][axis] + 1 < count(axis) && labels[at + step] != labels[at])
        add_change(point(lattice[at]), point(lattice[at + step]), labels[at]);
      step *= static_cast<std::size_t>(count(axis));
    }
  }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  return points;
}

double distance_to_nearest(const std::vector<Point>& points, const Point& p) {
  double squared = std::numeric_limits<double>::infinity();
  const auto compare = [&](const Point& q) {
    squared = std::min(squared, squared_distance(p, q));
    return (q.x - p.x) * (q.x - p.x) < squared;  // the next points may be nearer
  };
  const auto first =
      std::partition_point(points.begin(), points.end(), [&](const Point& q) { return q.x < p.x; });
  for (auto q = first; q != points.end() && compare(*q);) ++q;
  for (auto q = first; q != points.begin() && compare(*std::prev(q));) --q;
  return std::sqrt(squared);
}

bool is_on_isosurface(const LabelImage& image, const Point& p, double voxels, const VoxelWeights* weights) {
  std::set<LabelIndex> labels{reference_label(image, p, weights).label};
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const Vector d{i * image.spacing[0], j * image.spacing[1], k * image.spacing[2]};
        labels.insert(reference_label(image, p + voxels * d, weights).label);
      }
  return labels.size() > 1;
}

}  // namespace podm::test
