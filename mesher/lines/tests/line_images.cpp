#include "lines/tests/line_images.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lines/polyline.h"

namespace podm::test {

LabelImage image_of(std::array<int, 3> size, std::array<double, 3> spacing, unsigned num_labels,
                    const std::function<LabelIndex(const Point&)>& label) {
  LabelImage image = empty_image(size, spacing);
  image.labels.resize(num_labels);
  for (unsigned l = 0; l < num_labels; ++l) image.labels[l].value = l;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) image.voxels[image.index(i, j, k)] = label(center({i, j, k}));
  return image;
}

LabelImage polycrystal(Random& random, std::array<int, 3> size, std::array<double, 3> spacing,
                       unsigned num_grains, bool has_margin) {
  std::vector<Point> seeds;
  double apart = 0.7 * std::cbrt(size[0] * size[1] * size[2] / double(num_grains));
  while (seeds.size() < num_grains) {
    const Point seed{uniform(random, 0, size[0]), uniform(random, 0, size[1]), uniform(random, 0, size[2])};
    const bool is_free = std::none_of(seeds.begin(), seeds.end(),
                                      [&](const Point& other) { return distance(seed, other) < apart; });
    if (is_free) seeds.push_back(seed);
    apart *= 0.999;
  }
  return image_of(size, spacing, num_grains + 1, [&](const Point& p) {
    const auto is_outer = [&](double x, std::size_t a) { return x < 2 || x > size[a] - 3; };
    if (has_margin && (is_outer(p.x, 0) || is_outer(p.y, 1) || is_outer(p.z, 2))) return kBackground;
    const auto nearest = std::min_element(seeds.begin(), seeds.end(), [&](const Point& a, const Point& b) {
      return squared_distance(a, p) < squared_distance(b, p);
    });
    return static_cast<LabelIndex>(nearest - seeds.begin() + 1);
  });
}

LabelImage sectors(std::array<int, 3> size, unsigned num_sectors, const Point& center,
                   const Vector& direction) {
  const Vector w = (1 / std::sqrt(squared_length(direction))) * direction;
  const Vector other = std::fabs(w.x) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0};
  Vector u = cross(w, other);
  u = (1 / std::sqrt(squared_length(u))) * u;
  const Vector v = cross(w, u);
  return image_of(size, {1, 1, 1}, num_sectors + 1, [&](const Point& p) {
    const double angle = std::atan2(dot(p - center, v), dot(p - center, u)) / (2 * std::numbers::pi) + 0.5;
    return static_cast<LabelIndex>(1 + std::min(static_cast<unsigned>(angle * num_sectors), num_sectors - 1));
  });
}

LabelIndex LabelFunction::operator()(const Point& u) const {
  const auto clamped = [&](double x, std::size_t a) {
    return is_box_flat_ ? std::clamp(x, 0.0, image_.size[a] - 1.0) : x;
  };
  const auto& s = image_.spacing;
  return reference_label(image_, {clamped(u.x, 0) * s[0], clamped(u.y, 1) * s[1], clamped(u.z, 2) * s[2]},
                         weights_)
      .label;
}

std::set<LabelIndex> LabelFunction::labels_around(const Point& p, double radius) const {
  const Point u = to_index(image_, p);
  std::set<LabelIndex> labels{(*this)(u)};
  for (const double r : {radius, 0.5 * radius}) {
    for (int i = 0; i < 12; ++i) {
      const double z = (i + 0.5) / 6 - 1, to_axis = std::sqrt(1 - z * z);
      for (int j = 0; j < 16; ++j) {
        const double angle = (j + 0.5 * (i % 2)) * std::numbers::pi / 8;
        labels.insert((*this)(u + r * Vector{to_axis * std::cos(angle), to_axis * std::sin(angle), z}));
      }
    }
  }
  return labels;
}

double distance_to_arcs(const LineNetwork& network, const Point& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const LineArc& arc : network.arcs) least = std::min(least, nearest_on(arc.points, p).distance);
  return least;
}

std::vector<int> degrees(const LineNetwork& network) {
  std::vector<int> degrees(network.nodes.size());
  for (const LineArc& arc : network.arcs)
    for (const std::int32_t end : {arc.first_node, arc.last_node})
      if (end >= 0) ++degrees[static_cast<std::size_t>(end)];
  return degrees;
}

}  // namespace podm::test
