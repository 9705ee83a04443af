// Analytic phantoms: images for machines without data, at any resolution and of a fixed physical size.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "phantoms/phantom_abdomen.h"
#include "phantoms/phantom_crystal.h"
#include "phantoms/phantom_head.h"
#include "phantoms/phantom_shapes.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr int kSmallestSize = 16, kLargestSize = 1024;
constexpr int kMarginVoxels = 2;

struct Phantom {
  std::vector<Organ> organs;
  Vector half_extent_mm;          // around the origin; contains every organ
  double relative_z_spacing = 1;  // relative to the spacing along x and y
  int margin_voxels = kMarginVoxels;
};

std::vector<Organ> spheres() {
  const Shape shell = ellipsoid({-20, 0, 0}, {60, 60, 60});
  return {{1, "shell", shell},
          {2, "core", ellipsoid({-20, 0, 0}, {35, 35, 35})},
          {3, "neighbour", without(ellipsoid({62, 0, 0}, {36, 36, 36}), shell)}};
}

std::vector<Organ> torus_and_ball() {
  return {{1, "ring", torus(60, 22)}, {2, "ball", ellipsoid({0, 0, 0}, {30, 30, 30})}};
}

// Three equal spheres, each cut by the planes halfway to the others. All three meet along the z axis.
std::vector<Organ> bubbles() {
  constexpr double kRadius = 40, kFromAxis = 26;
  std::vector<Organ> organs;
  for (const std::uint32_t i : {0U, 1U, 2U}) {
    const double angle = 2 * std::numbers::pi * i / 3;
    const Point center{kFromAxis * std::cos(angle), kFromAxis * std::sin(angle), 0};
    const Vector reach{kRadius, kRadius, kRadius};
    const Shape nearest{[=](const Point& p) {
                          return std::hypot(p.x, p.y) * std::cos(std::numbers::pi / 3) -
                                 (p.x * std::cos(angle) + p.y * std::sin(angle));
                        },
                        center - reach, center + reach};
    organs.push_back({i + 1, fmt::format("bubble {}", i + 1), within(ellipsoid(center, reach), nearest)});
  }
  return organs;
}

// Shells that are 2, 4 and 6 mm thick: 1, 2 and 3 voxels at size 64.
std::vector<Organ> shells() {
  std::vector<Organ> organs;
  const auto add = [&](std::uint32_t label, const char* name, double radius_mm) {
    organs.push_back({label, name, ellipsoid({0, 0, 0}, {radius_mm, radius_mm, radius_mm})});
  };
  add(1, "thin shell", 60);
  add(4, "filling", 58);
  add(2, "middle shell", 48);
  add(4, "filling", 44);
  add(3, "thick shell", 34);
  add(4, "filling", 28);
  return organs;
}

Phantom phantom_of(const std::string& name) {
  if (name == "abdomen") return {abdomen_organs(), kAbdomenHalfExtent, 1.25};
  if (name == "bubbles") return {bubbles(), {66, 66, 40}};
  if (name == "crystal")
    return {.organs = crystal_grains(), .half_extent_mm = kCrystalHalfExtent, .margin_voxels = 0};
  if (name == "head") return {head_organs(), kHeadHalfExtent};
  if (name == "membrane") return {membrane_organs(), kAbdomenHalfExtent};
  if (name == "shells") return {shells(), {60, 60, 60}};
  if (name == "spheres") return {spheres(), {98, 60, 60}};
  if (name == "torus") return {torus_and_ball(), {82, 82, 30}};
  std::string known;
  for (const std::string& n : phantom_names()) known += " " + n;
  throw InputError("phantom:" + name + ": unknown phantom (known:" + known + ")");
}

/// The positions of voxel centers along one axis.
struct Axis {
  double first, spacing;
  int size;

  double at(int i) const { return first + spacing * i; }
  /// The first position that is not below `low`, and the first one above `high`, within the axis.
  int first_not_below(double low) const {
    return static_cast<int>(std::clamp(std::ceil((low - first) / spacing), 0.0, static_cast<double>(size)));
  }
  int end_of(double high) const {
    return static_cast<int>(
        std::clamp(std::floor((high - first) / spacing) + 1, 0.0, static_cast<double>(size)));
  }
};

Axis axis_of(const LabelImage& image, std::size_t axis) {
  return {image.voxel_to_ras[4 * axis + 3], image.spacing[axis], image.size[axis]};
}

/// An organ with its label index.
struct Paint {
  Shape shape;
  LabelIndex label;
};

// The last paint covers the others. Paints are therefore applied from the last to the first, on voxels that
// are still background.
void fill_row(LabelIndex* row, const std::vector<const Paint*>& paints, const Axis& x, double y, double z) {
  for (auto paint = paints.rbegin(); paint != paints.rend(); ++paint) {
    const Shape& shape = (*paint)->shape;
    if (y < shape.low.y || y > shape.high.y) continue;
    const int end = x.end_of(shape.high.x);
    for (int i = x.first_not_below(shape.low.x); i < end; ++i) {
      if (row[i] == kBackground && shape.value({x.at(i), y, z}) < 0) row[i] = (*paint)->label;
    }
  }
}

void fill_slice(LabelImage& image, const std::vector<Paint>& paints, int k) {
  const Axis x = axis_of(image, 0), y = axis_of(image, 1);
  const double z = axis_of(image, 2).at(k);
  std::vector<const Paint*> met;
  for (const Paint& paint : paints) {
    if (z >= paint.shape.low.z && z <= paint.shape.high.z) met.push_back(&paint);
  }
  for (int j = 0; j < y.size; ++j) fill_row(&image.voxels[image.index(0, j, k)], met, x, y.at(j), z);
}

void fill(LabelImage& image, const std::vector<Organ>& organs, int threads) {
  std::map<std::uint32_t, std::string> names;
  for (const Organ& organ : organs) names.emplace(organ.label, organ.name);
  image.labels = {{0, ""}};
  std::map<std::uint32_t, LabelIndex> index;
  for (const auto& [value, name] : names) {
    index[value] = static_cast<LabelIndex>(image.labels.size());
    image.labels.push_back({value, name});
  }
  std::vector<Paint> paints;
  for (const Organ& organ : organs) paints.push_back({organ.shape, index[organ.label]});
  image.voxels.assign(image.num_voxels(), kBackground);
  parallel_for(static_cast<std::size_t>(image.size[2]), num_threads(threads),
               [&](std::size_t k, std::size_t) { fill_slice(image, paints, static_cast<int>(k)); });
}

// Rounds up to a few bits. The spacing, and its product with half a number of voxels, is then exact in the
// single precision of NIfTI. The phantom and its file are therefore the same image.
double in_few_bits(double spacing) {
  constexpr int kBits = 12;
  int exponent = 0;
  const double fraction = std::frexp(spacing, &exponent);
  return std::ldexp(std::ceil(std::ldexp(fraction, kBits)), exponent - kBits);
}

}  // namespace

std::vector<std::string> phantom_names() {
  return {"abdomen", "bubbles", "crystal", "head", "membrane", "shells", "spheres", "torus"};
}

LabelImage make_phantom(const std::string& name, int size, int threads) {
  const Phantom phantom = phantom_of(name);
  if (size < kSmallestSize || size > kLargestSize) {
    throw InputError("phantom:" + name + "@" + std::to_string(size) + ": the size must be between " +
                     std::to_string(kSmallestSize) + " and " + std::to_string(kLargestSize) + " voxels");
  }
  const std::array<double, 3> half{phantom.half_extent_mm.x, phantom.half_extent_mm.y,
                                   phantom.half_extent_mm.z};
  const double spacing = 2 * *std::max_element(half.begin(), half.end()) / (size - 2 * phantom.margin_voxels);
  LabelImage image;
  image.spacing = {in_few_bits(spacing), in_few_bits(spacing),
                   in_few_bits(phantom.relative_z_spacing * spacing)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr double kRoundOff = 1e-9;  // without it the longest axis could get one voxel too many
    const double voxels = std::ceil(2 * half[axis] / image.spacing[axis] - kRoundOff);
    image.size[axis] = static_cast<int>(voxels) + 2 * phantom.margin_voxels;
    image.voxel_to_ras[5 * axis] = image.spacing[axis];
    image.voxel_to_ras[4 * axis + 3] = -0.5 * (image.size[axis] - 1) * image.spacing[axis];
  }
  fill(image, phantom.organs, threads);
  return image;
}

}  // namespace podm
