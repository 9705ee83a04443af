#include "sizing/make_size_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/foreground.h"
#include "image/working_frame.h"
#include "podm/errors.h"
#include "sizing/default_sizes.h"
#include "sizing/graded_grid.h"
#include "sizing/interface_distance.h"
#include "sizing/thin_layers.h"

namespace podm {

namespace {

constexpr float kUnbounded = std::numeric_limits<float>::infinity();

// The map that takes p to b(a(p)).
Affine then(const Affine& a, const Affine& b) {
  Affine c{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t i = 0; i < 3; ++i) c[4 * row + column] += b[4 * row + i] * a[4 * i + column];
      if (column == 3) c[4 * row + 3] += b[4 * row + 3];
    }
  return c;
}

// Maps points to node indices. Nodes are counted from voxel `first`, one every `stride` voxels.
Affine to_nodes(const LabelImage& image, const std::array<int, 3>& first, int stride) {
  Affine a = inverse(voxels_to_working(image));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    a[4 * axis + 3] -= first[axis];
    for (std::size_t column = 0; column < 4; ++column) a[4 * axis + column] /= stride;
  }
  return a;
}

double diagonal_mm(const LabelImage& image) {
  return std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
}

std::string text_of(const std::vector<std::uint32_t>& values) {
  return fmt::format("{}", fmt::join(values, ", "));
}

// Throws InputError if the labels do not touch, or one label is on both sides.
InterfaceDistances distances_to(const LabelImage& image, const InterfaceSize& near, int threads) {
  std::vector<unsigned char> side_of_label(image.labels.size(), 0);
  for (std::size_t label = 0; label < image.labels.size(); ++label)
    for (unsigned char side = 0; side < 2; ++side)
      if (std::count(near.labels[side].begin(), near.labels[side].end(), image.labels[label].value) > 0) {
        if (side_of_label[label] != 0)
          throw InputError(
              fmt::format("sizes at the interface of labels {} and {}: label {} is on both sides",
                          text_of(near.labels[0]), text_of(near.labels[1]), image.labels[label].value));
        side_of_label[label] = static_cast<unsigned char>(side + 1);
      }
  // With this reach every point around the outermost voxels of the part is beyond the width, except at the
  // image's border.
  const double reach_mm = near.width_mm + 2 * diagonal_mm(image);
  auto distances = interface_distances(image, side_of_label, reach_mm, threads);
  if (!distances)
    throw InputError(fmt::format("sizes at the interface of labels {} and {}: they have no voxels that touch",
                                 text_of(near.labels[0]), text_of(near.labels[1])));
  return std::move(*distances);
}

// Bounds at nodes, which are every n-th voxel of an image along each axis. A bound at a point becomes a bound
// at the nearest node, increased by the slope times the distance.
class Graded {
 public:
  Graded(const LabelImage& image, double slope) : image_(image), slope_(slope) {
    while (num_nodes() > kMostGradedNodes) ++stride_;
    radii_.assign(num_nodes(), kUnbounded);
  }

  // `voxel` need not be a whole number, nor lie in the image. There are no nodes beyond the image.
  void bound(const std::array<double, 3>& voxel, double radius_mm) {
    std::array<int, 3> node;
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double nearest = std::round(voxel[axis] / stride_);
      if (!(nearest >= 0 && nearest < size()[axis])) return;
      node[axis] = static_cast<int>(nearest);
      const double along = (voxel[axis] - nearest * stride_) * image_.spacing[axis];
      squared += along * along;
    }
    float& known = radii_[index(node)];
    known = std::min(known, static_cast<float>(radius_mm + slope_ * std::sqrt(squared)));
  }

  // Returns nothing if there is no bound.
  std::optional<ScalarGrid> finish() && {
    std::array<double, 3> spacing = image_.spacing;
    for (double& s : spacing) s *= stride_;
    grade(size(), spacing, slope_, radii_);
    if (radii_[0] == kUnbounded) return std::nullopt;  // then all other values are unbounded, too
    return ScalarGrid(size(), to_nodes(image_, {0, 0, 0}, stride_),
                      std::make_shared<const std::vector<float>>(std::move(radii_)));
  }

 private:
  std::array<int, 3> size() const {
    std::array<int, 3> size;
    for (std::size_t axis = 0; axis < 3; ++axis)
      size[axis] = (image_.size[axis] - 1 + stride_ / 2) / stride_ + 1;
    return size;
  }
  std::size_t num_nodes() const {
    const auto [x, y, z] = size();
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(y) * static_cast<std::size_t>(z);
  }
  std::size_t index(const std::array<int, 3>& node) const {
    const auto [nx, ny, nz] = size();
    return (static_cast<std::size_t>(node[2]) * static_cast<std::size_t>(ny) +
            static_cast<std::size_t>(node[1])) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(node[0]);
  }

  const LabelImage& image_;
  const double slope_;
  int stride_ = 1;
  std::vector<float> radii_;
};

// Calls use(voxel, its number) for every voxel of a grid.
template <class Use>
void for_each_voxel(const std::array<int, 3>& size, const Use& use) {
  std::size_t number = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++number)
        use(std::array<double, 3>{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)},
            number);
}

void bound_by_labels(const LabelImage& image, const SizeOptions& sizes, Graded& graded) {
  const std::vector<double> radius_of = radii_of_labels_mm(image, sizes);
  for_each_voxel(image.size, [&](const std::array<double, 3>& voxel, std::size_t number) {
    const LabelIndex label = image.voxels[number];
    if (label != kBackground && std::isfinite(radius_of[label])) graded.bound(voxel, radius_of[label]);
  });
}

// Applies the size image at the image's voxels and at the size image's own voxels, as either grid may be
// finer.
void bound_by_size_image(const LabelImage& image, const SizeOptions& sizes, const ScalarGrid& grid,
                         Graded& graded) {
  const Affine to_working = voxels_to_working(image);
  for_each_voxel(image.size, [&](const std::array<double, 3>& voxel, std::size_t) {
    const double radius = grid.at(map(to_working, Point{voxel[0], voxel[1], voxel[2]}));
    if (std::isfinite(radius)) graded.bound(voxel, sizes.image_factor * radius);
  });
  const Affine to_voxels = then(inverse(grid.to_nodes()), inverse(to_working));
  for_each_voxel(grid.size(), [&](const std::array<double, 3>& voxel, std::size_t number) {
    const double radius = grid.values()[number];
    if (radius > 0) graded.bound(map(to_voxels, voxel), sizes.image_factor * radius);
  });
}

void bound_near(const InterfaceDistances& distances, const InterfaceSize& near, double slope,
                Graded& graded) {
  for_each_voxel(distances.size, [&](std::array<double, 3> voxel, std::size_t number) {
    for (std::size_t axis = 0; axis < 3; ++axis) voxel[axis] += distances.first[axis];
    const double beyond_mm = std::max(0.0, distances.distance_mm[number] - near.width_mm);
    if (std::isfinite(beyond_mm)) graded.bound(voxel, near.radius_mm + slope * beyond_mm);
  });
}

}  // namespace

std::uint64_t bytes_of_size_grid(const LabelImage& image, const SizeOptions& sizes) {
  std::uint64_t volumes = sizes.grade > 0 ? 1 : 0;
  if (!sizes.near.empty()) volumes += sizes.near.size() + 1;  // and the distances for one direction of faces
  const std::uint64_t layers = sizes.thin == Thin::kKeep ? kBytesPerVoxelOfLayers : 0;
  return (volumes * sizeof(float) + layers) * image.num_voxels();
}

ScalarGrid size_image_grid(const LabelImage& image, const std::shared_ptr<const SizeImage>& sizes) {
  return {sizes->size, then(working_to_world(image), inverse(sizes->voxel_to_ras)),
          ScalarGrid::Values(sizes, &sizes->radius_mm)};
}

std::shared_ptr<const SizeGrid> make_size_grid(const LabelImage& image, const SizeOptions& sizes,
                                               int threads) {
  if (sizes.image == nullptr && sizes.near.empty() && sizes.grade == 0) return nullptr;
  const Box object = foreground_bounds(image, threads);
  std::optional<Graded> graded;
  if (sizes.grade > 0) bound_by_labels(image, sizes, graded.emplace(image, sizes.grade));
  std::optional<SizeGrid::Image> by_image;
  if (sizes.image != nullptr) {
    by_image.emplace(SizeGrid::Image{size_image_grid(image, sizes.image), sizes.image_factor});
    if (!by_image->radius_mm.meets(object))
      throw InputError(
          fmt::format("{}: the size image and the object do not overlap; is the size image in another space?",
                      sizes.image->path));
    if (by_image->radius_mm.range_in(object).most == 0)
      throw InputError(fmt::format("{}: no voxel with a size lies at the object", sizes.image->path));
    if (graded) bound_by_size_image(image, sizes, by_image->radius_mm, *graded);
  }
  std::vector<NearInterface> near;
  for (const InterfaceSize& asked : sizes.near) {
    InterfaceDistances distances = distances_to(image, asked, threads);
    if (graded) bound_near(distances, asked, sizes.grade, *graded);
    near.emplace_back(
        ScalarGrid(distances.size, to_nodes(image, distances.first, 1),
                   std::make_shared<const std::vector<float>>(std::move(distances.distance_mm))),
        image.spacing, asked.width_mm, asked.radius_mm);
  }
  return std::make_shared<const SizeGrid>(std::move(by_image), std::move(near),
                                          graded ? std::move(*graded).finish() : std::nullopt, object);
}

}  // namespace podm
