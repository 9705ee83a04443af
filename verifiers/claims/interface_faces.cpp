#include "claims/interface_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/circumcenter.h"
#include "image/raw_image.h"

namespace podm::verify {

namespace {

[[noreturn]] void refuse_near(const Image& image, const InterfaceSize& near, const std::string& fault) {
  refuse(image.path, fmt::format("--size-near {}: {}", near.text, fault));
}

// The side of an interface that each voxel is on: 1, 2, or 0 for neither.
class Sides {
 public:
  Sides(const Image& image, const InterfaceSize& near) : size_(image.size) {
    check(image, near);
    const auto side_of = [&](std::uint32_t label) -> unsigned char {
      for (unsigned char side = 0; side < 2; ++side)
        if (std::count(near.labels[side].begin(), near.labels[side].end(), label) > 0) return side + 1;
      return 0;
    };
    outside_ = side_of(0);
    sides_.reserve(image.voxels.size());
    for (const std::uint32_t label : image.voxels) {
      const std::size_t n = sides_.size();
      sides_.push_back(n > 0 && image.voxels[n - 1] == label ? sides_.back() : side_of(label));
    }
  }

  unsigned char operator()(const std::array<int, 3>& v) const {
    std::size_t number = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      if (v[axis] < 0 || v[axis] >= size_[axis]) return outside_;
      number = number * static_cast<std::size_t>(size_[axis]) + static_cast<std::size_t>(v[axis]);
    }
    return sides_[number];
  }

 private:
  static void check(const Image& image, const InterfaceSize& near) {
    for (const std::uint32_t label : near.labels[0])
      if (std::count(near.labels[1].begin(), near.labels[1].end(), label) > 0)
        refuse_near(image, near, fmt::format("label {} is on both sides", label));
    for (const auto& labels : near.labels)
      for (const std::uint32_t label : labels)
        if (label != 0 && std::find(image.voxels.begin(), image.voxels.end(), label) == image.voxels.end())
          refuse_near(image, near, fmt::format("no voxel has label {}", label));
  }

  std::array<int, 3> size_;
  unsigned char outside_ = 0;
  std::vector<unsigned char> sides_;
};

std::vector<VoxelFace> find_faces(const Image& image, const InterfaceSize& near) {
  const Sides side(image, near);
  std::vector<VoxelFace> faces;
  const auto [nx, ny, nz] = image.size;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        const unsigned char own = side({i, j, k});
        if (own == 0) continue;
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          std::array<int, 3> before{i, j, k};
          --before[axis];
          if (own + side(before) == 3) faces.push_back({{i, j, k}, axis});
        }
      }
  if (faces.empty()) refuse_near(image, near, "no voxels of the two sides touch");
  return faces;
}

double squared(double x) { return x * x; }

double distance(const Bounds& box, const Point& p) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += squared(std::max({box.low[axis] - p[axis], p[axis] - box.high[axis], 0.0}));
  return std::sqrt(sum);
}

}  // namespace

InterfaceFaces::InterfaceFaces(const Image& image, const InterfaceSize& near)
    : bound_(near), spacing_(image.spacing), faces_(find_faces(image, near)), tree_(boxes()) {}

Point InterfaceFaces::in_mm(const Point& voxel) const {
  return {voxel[0] * spacing_[0], voxel[1] * spacing_[1], voxel[2] * spacing_[2]};
}

Bounds InterfaceFaces::box_of(const VoxelFace& face) const {
  Bounds box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = (face.voxel[axis] - 0.5) * spacing_[axis];
    box.high[axis] = axis == face.axis ? box.low[axis] : (face.voxel[axis] + 0.5) * spacing_[axis];
  }
  return box;
}

std::vector<Bounds> InterfaceFaces::boxes() const {
  std::vector<Bounds> boxes;
  boxes.reserve(faces_.size());
  for (const VoxelFace& face : faces_) boxes.push_back(box_of(face));
  return boxes;
}

// Returns by how much the squared width exceeds the squared distance from a face to the circumcenter.
template <class T>
T InterfaceFaces::excess(const VoxelFace& face, const CellPoints& p, const VoxelMap& to_voxels) const {
  const auto center = circumcenter<T>(p);
  if constexpr (std::is_same_v<T, Interval>)
    if (!center) return {-1, 1};
  const Vector<T> voxel = to_voxels(*center);
  T sum(0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double first = face.voxel[axis] - 0.5, last = axis == face.axis ? first : first + 1;
    const T beyond = larger<T>(larger<T>(T(first) - voxel[axis], voxel[axis] - T(last)), T(0));
    const T along = T(spacing_[axis]) * beyond;
    sum = sum + along * along;
  }
  return T(bound_.width_mm) * T(bound_.width_mm) - sum;
}

// Doubles decide only cases that are further from the width than the rounding of the circumcenter and of all
// else.
bool InterfaceFaces::contains(const CellPoints& p, const Circumsphere& sphere, const VoxelMap& to_voxels,
                              std::uint64_t& num_exact) const {
  const Point center = in_mm(sphere.voxel);
  const double width_mm = bound_.width_mm;
  const double margin_mm = 1e-6 * (spacing_[0] + spacing_[1] + spacing_[2]) + 1e-9 * width_mm;
  double limit_mm = width_mm + margin_mm;
  bool is_found = false;
  tree_.for_each_within(
      limit_mm, [&](const Bounds& box) { return distance(box, center); },
      [&](std::uint32_t i) {
        const double found_mm = distance(box_of(faces_[i]), center);
        if (found_mm > limit_mm) return;
        is_found = found_mm < width_mm - margin_mm ||
                   sign_of([&]<class T>(T) { return excess<T>(faces_[i], p, to_voxels); }, num_exact) >= 0;
        if (is_found) limit_mm = -1;
      });
  return is_found;
}

double InterfaceFaces::distance_mm(const Point& voxel, double limit_mm) const {
  const Point p = in_mm(voxel);
  double least_mm = limit_mm;
  tree_.for_each_within(
      least_mm, [&](const Bounds& box) { return distance(box, p); },
      [&](std::uint32_t i) { least_mm = std::min(least_mm, distance(box_of(faces_[i]), p)); });
  return least_mm;
}

}  // namespace podm::verify
