#include "claims/check_labels_circumcenter.h"

#include <cmath>
#include <limits>

#include "image/label_function.h"
#include "parallel.h"
#include "ranks/part.h"

namespace podm::verify {

namespace {

template <class Number>
using Vector = std::array<Number, 3>;

template <class Number>
Vector<Number> cross(const Vector<Number>& a, const Vector<Number>& b) {
  return {Number(a[1] * b[2] - a[2] * b[1]), Number(a[2] * b[0] - a[0] * b[2]),
          Number(a[0] * b[1] - a[1] * b[0])};
}

template <class Number>
Number dot(const Vector<Number>& a, const Vector<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double length(const Point& a) { return std::sqrt(dot(a, a)); }

template <class Number>
struct Solution {
  std::array<Vector<Number>, 3> edges, normals;
  Number determinant;
  Vector<Number> center;  // relative to v0
};

// Cramer's rule, as in the header's comment.
template <class Number>
Solution<Number> solve(const std::array<Vector<Number>, 4>& v) {
  Solution<Number> s;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) s.edges[i][axis] = v[i + 1][axis] - v[0][axis];
  for (std::size_t i = 0; i < 3; ++i) s.normals[i] = cross(s.edges[(i + 1) % 3], s.edges[(i + 2) % 3]);
  s.determinant = dot(s.edges[0], s.normals[0]);
  if (s.determinant == 0) return s;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Number sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += dot(s.edges[i], s.edges[i]) * s.normals[i][axis];
    s.center[axis] = sum / (2 * s.determinant);
  }
  return s;
}

double error_mm(const Solution<double>& s, double point_error) {
  constexpr double kEpsilon = 0x1p-52;
  const double a = length(s.edges[0]), b = length(s.edges[1]), c = length(s.edges[2]);
  const double radius = length(s.center), product = a * b * c;
  const double determinant = std::abs(s.determinant) - 7 * kEpsilon * product;
  const double shift = 2 * std::sqrt(3.0) * point_error;
  const double k = (length(s.normals[0]) + length(s.normals[1]) + length(s.normals[2])) / determinant;
  if (!(determinant > 0) || !(k * shift < 0.5)) return std::numeric_limits<double>::infinity();
  const double moved = k * (radius * shift + shift * shift / 2) / (1 - k * shift);
  const double evaluated = kEpsilon * (product * (8 * (a + b + c) + 7 * radius) / determinant + radius);
  // The bound itself is evaluated in doubles, from a radius that is off by `evaluated`.
  return 1.01 * (moved + evaluated + std::sqrt(3.0) * point_error);
}

}  // namespace

CircumcenterLocator::CircumcenterLocator(const Mesh& mesh, const Image& image, const ImageFrame& frame,
                                         int threads)
    : mesh_(mesh), points_(mesh.vertices.size()) {
  std::vector<Point> largest(static_cast<std::size_t>(threads), Point{});
  parallel_ranges(points_.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t i = begin; i < end; ++i) {
      const Point u = frame.to_voxels(mesh.vertices[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        points_[i][axis] = u[axis] * image.spacing[axis];
        largest[thread][axis] = std::max(largest[thread][axis], std::abs(u[axis]));
      }
    }
  });
  Point voxels{}, world_rounding;
  for (const std::vector<Point>& of_rank : gather(ranks_of(mesh), largest))
    largest.insert(largest.end(), of_rank.begin(), of_rank.end());
  for (const Point& part : largest)
    for (std::size_t axis = 0; axis < 3; ++axis) voxels[axis] = std::max(voxels[axis], part[axis]);
  for (std::size_t row = 0; row < 3; ++row) {
    const double* a = image.voxel_to_ras.data() + 4 * row;
    world_rounding[row] = 0x1p-50 * (std::abs(a[0]) * voxels[0] + std::abs(a[1]) * voxels[1] +
                                     std::abs(a[2]) * voxels[2] + std::abs(a[3]));
  }
  const Point moved = frame.voxel_movement(world_rounding);
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // 2^-50 also covers the rounding of points_ and of the edges taken from them.
    const double error = (moved[axis] + 0x1p-50 * voxels[axis]) * image.spacing[axis];
    point_error_mm_ = std::max(point_error_mm_, error);
    voxels_per_mm_[axis] = 1 / image.spacing[axis];
    squared += voxels_per_mm_[axis] * voxels_per_mm_[axis];
    voxel_rounding_ += 0x1p-50 * (voxels[axis] + 1);
  }
  l1_voxels_per_mm_ = std::sqrt(squared);
}

LocatedPoint CircumcenterLocator::circumcenter(CellId cell) const {
  const auto& v = mesh_.cells[cell];
  const Point& origin = points_[v[0]];
  const Solution<double> s = solve<double>({origin, points_[v[1]], points_[v[2]], points_[v[3]]});
  LocatedPoint located;
  if (s.determinant == 0) {
    located.error = std::numeric_limits<double>::infinity();
    return located;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    located.voxels[axis] = (origin[axis] + s.center[axis]) * voxels_per_mm_[axis];
  const double reach = 0x1p-50 * length(s.center) * l1_voxels_per_mm_;  // rounding of the sum and its scaling
  located.error = error_mm(s, point_error_mm_) * l1_voxels_per_mm_ + voxel_rounding_ + reach;
  return located;
}

LocatedPoint CircumcenterLocator::centroid(CellId cell) const {
  LocatedPoint located;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double sum = 0;
    for (const VertexId v : mesh_.cells[cell]) sum += points_[v][axis];
    located.voxels[axis] = sum / 4 * voxels_per_mm_[axis];
  }
  located.error = std::sqrt(3.0) * point_error_mm_ * l1_voxels_per_mm_ + 4 * voxel_rounding_;
  return located;
}

ExactCircumcenterLabel::ExactCircumcenterLabel(const Mesh& mesh, const Image& image, Space space)
    : mesh_(mesh), image_(image), mesh_to_voxels_(exact_mesh_to_voxels(image.voxel_to_ras, space)) {}

std::optional<std::uint32_t> ExactCircumcenterLabel::operator()(CellId cell) const {
  std::array<Vector<mpq_class>, 4> v;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& p = mesh_.vertices[mesh_.cells[cell][i]];
    for (std::size_t r = 0; r < 3; ++r) {
      const mpq_class* m = &mesh_to_voxels_[4 * r];
      v[i][r] = (m[0] * mpq_class(p[0]) + m[1] * mpq_class(p[1]) + m[2] * mpq_class(p[2]) + m[3]) *
                mpq_class(image_.spacing[r]);
    }
  }
  const Solution<mpq_class> s = solve<mpq_class>(v);
  if (s.determinant == 0) return std::nullopt;
  std::array<mpq_class, 3> u;
  for (std::size_t axis = 0; axis < 3; ++axis)
    u[axis] = (v[0][axis] + s.center[axis]) / mpq_class(image_.spacing[axis]);
  return LabelFunction(image_).exact_label_at(u);
}

}  // namespace podm::verify
