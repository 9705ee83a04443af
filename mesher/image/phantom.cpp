// Analytic phantoms: images for machines without data, at any resolution and of one physical size.
#include <algorithm>
#include <array>
#include <map>
#include <thread>

#include "image/phantom_abdomen.h"
#include "image/phantom_shapes.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

constexpr int kSmallestSize = 16, kLargestSize = 1024;
constexpr int kMarginVoxels = 2;

struct Phantom {
  std::vector<Organ> organs;
  Vector half_extent_mm;
};

std::vector<Organ> spheres() {
  return {
      {1, "shell", ellipsoid({-20, 0, 0}, {60, 60, 60})},
      {2, "core", ellipsoid({-20, 0, 0}, {35, 35, 35})},
      {3, "neighbour", without(ellipsoid({62, 0, 0}, {36, 36, 36}), ellipsoid({-20, 0, 0}, {60, 60, 60}))}};
}

std::vector<Organ> torus() {
  const Shape ring{[](const Point& p) { return std::hypot(std::hypot(p.x, p.y) - 60, p.z) - 22; },
                   {-82, -82, -22},
                   {82, 82, 22}};
  return {{1, "ring", ring}, {2, "ball", ellipsoid({0, 0, 0}, {30, 30, 30})}};
}

Phantom phantom_of(const std::string& name) {
  if (name == "abdomen") return {abdomen_organs(), {165, 112, 97}};
  if (name == "spheres") return {spheres(), {98, 60, 60}};
  if (name == "torus") return {torus(), {82, 82, 30}};
  std::string known;
  for (const std::string& n : phantom_names()) known += " " + n;
  throw InputError("phantom:" + name + ": unknown phantom (known:" + known + ")");
}

bool holds(const Shape& shape, const Point& p) {
  return p.x >= shape.low.x && p.x <= shape.high.x && p.y >= shape.low.y && p.y <= shape.high.y &&
         p.z >= shape.low.z && p.z <= shape.high.z && shape.value(p) < 0;
}

void fill_slice(LabelImage& image, const std::vector<Organ>& organs,
                const std::vector<LabelIndex>& index_of_organ, int k) {
  const auto& a = image.voxel_to_ras;
  for (int j = 0; j < image.size[1]; ++j) {
    for (int i = 0; i < image.size[0]; ++i) {
      const Point p{a[0] * i + a[3], a[5] * j + a[7], a[10] * k + a[11]};
      for (std::size_t o = organs.size(); o-- > 0;) {
        if (!holds(organs[o].shape, p)) continue;
        image.voxels[image.index(i, j, k)] = index_of_organ[o];
        break;
      }
    }
  }
}

void fill(LabelImage& image, const std::vector<Organ>& organs) {
  std::map<std::uint32_t, std::string> names;
  for (const Organ& organ : organs) names.emplace(organ.label, organ.name);
  image.labels = {{0, ""}};
  std::map<std::uint32_t, LabelIndex> index;
  for (const auto& [value, name] : names) {
    index[value] = static_cast<LabelIndex>(image.labels.size());
    image.labels.push_back({value, name});
  }
  std::vector<LabelIndex> index_of_organ;
  for (const Organ& organ : organs) index_of_organ.push_back(index[organ.label]);
  image.voxels.assign(image.num_voxels(), kBackground);
  const int num_threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::jthread> threads;
  for (int t = 0; t < num_threads; ++t) {
    threads.emplace_back([&, t] {
      for (int k = t; k < image.size[2]; k += num_threads) fill_slice(image, organs, index_of_organ, k);
    });
  }
}

}  // namespace

std::vector<std::string> phantom_names() { return {"abdomen", "spheres", "torus"}; }

LabelImage make_phantom(const std::string& name, int size) {
  const Phantom phantom = phantom_of(name);
  if (size < kSmallestSize || size > kLargestSize) {
    throw InputError("phantom:" + name + "@" + std::to_string(size) + ": the size must be between " +
                     std::to_string(kSmallestSize) + " and " + std::to_string(kLargestSize) + " voxels");
  }
  const std::array<double, 3> half{phantom.half_extent_mm.x, phantom.half_extent_mm.y,
                                   phantom.half_extent_mm.z};
  const double spacing = 2 * *std::max_element(half.begin(), half.end()) / (size - 2 * kMarginVoxels);
  LabelImage image;
  image.spacing = {spacing, spacing, spacing};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    image.size[axis] = static_cast<int>(std::ceil(2 * half[axis] / spacing)) + 2 * kMarginVoxels;
    image.voxel_to_ras[5 * axis] = spacing;
    image.voxel_to_ras[4 * axis + 3] = -0.5 * (image.size[axis] - 1) * spacing;
  }
  fill(image, phantom.organs);
  return image;
}

}  // namespace podm
