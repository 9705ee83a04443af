#include "values/cell_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/point.h"
#include "runtime/parallel_for.h"
#include "values/exact_numbers.h"

namespace podm {

namespace {

// The largest errors that doubles may have: that of a mean over the largest absolute value in the cell, and
// that of the volumes over the covered volume.
constexpr double kTolerance = 2.5e-13;
// A voxel counts for the least and the largest value if the cell has more than this share of its volume in
// it.
constexpr double kLeastShare = 1e-12;
constexpr std::size_t kCellsAtOnce = 1 << 9;

// A voxel is one cube of the grid, of one value.
template <class Voxel>
class VoxelField {
 public:
  static constexpr int kParts = 1;
  using Field = ConstantField;

  VoxelField(const ValueImage& image, const std::vector<Voxel>& values)
      : size_(image.size), values_(values) {}

  int size(std::size_t axis) const { return size_[axis]; }  // in cubes
  bool has(const std::array<int, 3>& cube) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (cube[axis] < 0 || cube[axis] >= size(axis)) return false;
    return true;
  }
  double value_in(const std::array<int, 3>& cube) const { return at(cube); }
  /// Returns the integral of the value less `reference` over the overlap.
  template <class Real>
  Real integral(const std::array<int, 3>& cube, double reference, const std::array<Real, 1>& moments) const {
    return (Real(at(cube)) - Real(reference)) * moments[0];
  }
  double farthest(const std::array<int, 3>& cube, double reference) const {
    return std::abs(at(cube) - reference);
  }

 protected:
  double at(const std::array<int, 3>& voxel) const {
    const auto i = static_cast<std::size_t>(voxel[0]), j = static_cast<std::size_t>(voxel[1]),
               k = static_cast<std::size_t>(voxel[2]);
    return values_[(k * static_cast<std::size_t>(size_[1]) + j) * static_cast<std::size_t>(size_[0]) + i];
  }

  const std::array<int, 3> size_;

 private:
  const std::vector<Voxel>& values_;
};

// Eight cubes make a voxel: the values are trilinear in each.
template <class Voxel>
class InterpolatedField : private VoxelField<Voxel> {
 public:
  static constexpr int kParts = 2;
  using Field = TrilinearField;
  using VoxelField<Voxel>::VoxelField;

  int size(std::size_t axis) const { return kParts * this->size_[axis]; }
  bool has(const std::array<int, 3>& cube) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (cube[axis] < 0 || cube[axis] >= size(axis)) return false;
    return true;
  }
  double value_in(const std::array<int, 3>& cube) const {
    return this->at({cube[0] / 2, cube[1] / 2, cube[2] / 2});
  }
  template <class Real>
  Real integral(const std::array<int, 3>& cube, double reference, const std::array<Real, 8>& moments) const {
    const auto corners = corners_of(cube);
    std::array<Real, 8> coefficients;
    for (std::size_t n = 0; n < 8; ++n) coefficients[n] = Real(corners[n]) - Real(reference);
    // From values at the centers below and above to a constant and a slope, axis by axis.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool is_lower_half = cube[axis] % 2 == 0;  // its lower face is halfway between two centers
      for (std::size_t n = 0; n < 8; ++n) {
        if ((n >> axis & 1) != 0) continue;
        Real& low = coefficients[n];
        Real& high = coefficients[n | std::size_t{1} << axis];
        const Real slope = (high - low) / 2;
        if (is_lower_half) low += slope;
        high = slope;
      }
    }
    Real sum = 0;
    for (std::size_t n = 0; n < 8; ++n) sum += coefficients[n] * moments[n];
    return sum;
  }
  double farthest(const std::array<int, 3>& cube, double reference) const {
    double farthest = 0;
    for (const double corner : corners_of(cube)) farthest = std::max(farthest, std::abs(corner - reference));
    return farthest;
  }

 private:
  // The values at the centers around the cube; bit `axis` of the position is set for the upper one.
  std::array<double, 8> corners_of(const std::array<int, 3>& cube) const {
    std::array<double, 8> corners;
    for (std::size_t n = 0; n < 8; ++n) {
      std::array<int, 3> voxel;
      for (std::size_t axis = 0; axis < 3; ++axis)
        voxel[axis] =
            std::clamp((cube[axis] + 1) / 2 - 1 + static_cast<int>(n >> axis & 1), 0, this->size_[axis] - 1);
      corners[n] = this->at(voxel);
    }
    return corners;
  }
};

// The sums over the cubes that a cell overlaps.
template <class Real>
struct Sums {
  Real covered = 0, outside = 0;  // volumes
  Real integral = 0;              // of the value less `reference`, over the covered part
  double reference = 0;           // the value of one of the voxels
  double farthest = 0;            // the largest difference of a value from the reference
  double least = std::numeric_limits<double>::infinity(), largest = -std::numeric_limits<double>::infinity();

  bool has_values() const { return least <= largest; }
  double largest_magnitude() const { return std::max(std::abs(least), std::abs(largest)); }
};

template <class Real>
Real volume_of(const std::array<GridPoint<Real>, 4>& p) {
  const auto edge = [&](std::size_t n, std::size_t axis) { return Real(p[n][axis] - p[0][axis]); };
  const auto minor = [&](std::size_t a, std::size_t b) {
    return Real(edge(2, a) * edge(3, b) - edge(2, b) * edge(3, a));
  };
  return (edge(1, 0) * minor(1, 2) + edge(1, 1) * minor(2, 0) + edge(1, 2) * minor(0, 1)) / 6;
}

// Computes the values of one cell after the other.
template <class Values>
class CellIntegrals {
 public:
  CellIntegrals(const Values& values, const GridFrame& frame) : values_(values), frame_(frame) {}

  CellValue operator()(std::array<std::array<double, 3>, 4> cell) {
    if (!frame_.keeps_orientation()) std::swap(cell[2], cell[3]);
    const LocalCorners<double> local = frame_.local(cell);
    if (!may_overlap(local)) return {};
    if (const auto value = value_if_accurate(with_doubles_, local)) return *value;
    const auto exact = exact_corners(cell, local.origin);
    if (const auto value = value_if_accurate(with_quads_, rounded<Quad>(exact, local.origin))) return *value;
    return value_of(sums_of(with_rationals_, exact, local.origin));
  }

 private:
  bool may_overlap(const LocalCorners<double>& local) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double reach = 0;
      for (const auto& corner : local.corners) reach = std::max(reach, corner[axis]);
      if (local.origin[axis] >= values_.size(axis) || local.origin[axis] + reach < 0) return false;
    }
    return true;
  }

  // Returns none if the bound on rounding errors is too large.
  template <class Real>
  std::optional<CellValue> value_if_accurate(GridOverlap<Real, typename Values::Field>& overlap,
                                             const LocalCorners<Real>& local) const {
    const Sums<Real> sums = sums_of(overlap, local.corners, local.origin);
    const double error = overlap.volume_error() + error_of_corners(local.corners),
                 covered = static_cast<double>(sums.covered);
    const bool is_accurate = sums.has_values() && error < kTolerance * covered &&
                             error * sums.farthest <= kTolerance * sums.largest_magnitude() * covered;
    return is_accurate ? std::optional(value_of(sums)) : std::nullopt;
  }

  // Bounds the change of the volumes by roundings of corners and of cut edges, as by a shift of each facet.
  template <class Real>
  static double error_of_corners(const std::array<GridPoint<Real>, 4>& corners) {
    constexpr double kRoundings = 4;
    double extent = 1, area = 0;
    std::array<Point, 4> p;
    for (std::size_t n = 0; n < 4; ++n) {
      p[n] = {static_cast<double>(corners[n][0]), static_cast<double>(corners[n][1]),
              static_cast<double>(corners[n][2])};
      extent = std::max({extent, p[n].x, p[n].y, p[n].z});
    }
    for (std::size_t n = 0; n < 4; ++n) {
      const Point &a = p[n], &b = p[(n + 1) % 4], &c = p[(n + 2) % 4];
      area += std::sqrt(squared_length(cross(b - a, c - a))) / 2;
    }
    return kRoundings * unit_roundoff<Real>() * extent * area;
  }

  template <class Real>
  Sums<Real> sums_of(GridOverlap<Real, typename Values::Field>& overlap,
                     const std::array<GridPoint<Real>, 4>& corners, const std::array<int, 3>& origin) const {
    Sums<Real> sums;
    const Real least_volume = volume_of(corners) * kLeastShare;
    bool is_first = true;
    overlap(corners, [&](std::array<int, 3> cube, const auto& moments) {
      for (std::size_t axis = 0; axis < 3; ++axis) cube[axis] += origin[axis];
      if (!values_.has(cube)) {
        sums.outside += moments[0];
        return;
      }
      if (std::exchange(is_first, false)) sums.reference = values_.value_in(cube);
      sums.covered += moments[0];
      sums.integral += values_.integral(cube, sums.reference, moments);
      sums.farthest = std::max(sums.farthest, values_.farthest(cube, sums.reference));
      if (!(moments[0] > least_volume)) return;
      sums.least = std::min(sums.least, values_.value_in(cube));
      sums.largest = std::max(sums.largest, values_.value_in(cube));
    });
    return sums;
  }

  template <class Real>
  static CellValue value_of(const Sums<Real>& sums) {
    if (!sums.has_values()) return {};
    constexpr double kCubes = Values::kParts * Values::kParts * Values::kParts;
    const Real whole = sums.covered + sums.outside;
    return {.mean = static_cast<double>(Real(sums.reference + sums.integral / sums.covered)),
            .least = sums.least,
            .largest = sums.largest,
            .covered_share = std::min(1.0, static_cast<double>(Real(sums.covered / whole))),
            .covered_voxels = static_cast<double>(sums.covered) / kCubes};
  }

  std::array<GridPoint<Rational>, 4> exact_corners(const std::array<std::array<double, 3>, 4>& cell,
                                                   const std::array<int, 3>& origin) const {
    std::array<GridPoint<Rational>, 4> corners;
    for (std::size_t n = 0; n < 4; ++n) {
      corners[n] = frame_.exact(cell[n]);
      for (std::size_t axis = 0; axis < 3; ++axis) corners[n][axis] -= origin[axis];
    }
    return corners;
  }

  template <class Real>
  static LocalCorners<Real> rounded(const std::array<GridPoint<Rational>, 4>& exact,
                                    const std::array<int, 3>& origin) {
    LocalCorners<Real> local{.origin = origin, .corners = {}};
    for (std::size_t n = 0; n < 4; ++n)
      for (std::size_t axis = 0; axis < 3; ++axis) local.corners[n][axis] = static_cast<Real>(exact[n][axis]);
    return local;
  }

  const Values& values_;
  const GridFrame& frame_;
  GridOverlap<double, typename Values::Field> with_doubles_;
  GridOverlap<Quad, typename Values::Field> with_quads_;
  GridOverlap<Rational, typename Values::Field> with_rationals_;
};

template <class Values>
std::vector<CellValue> values_of_cells(const TetMesh& mesh, const Values& values,
                                       const std::array<Rational, 12>& grid_to_mesh, int threads) {
  const GridFrame frame(grid_to_mesh, Values::kParts);
  std::vector<CellValue> of_cells(mesh.cells.size());
  parallel_for_ranges(
      mesh.cells.size(), kCellsAtOnce, num_threads(threads),
      [&](std::size_t begin, std::size_t end, std::size_t) {
        CellIntegrals<Values> integrals(values, frame);
        for (std::size_t c = begin; c < end; ++c) {
          const auto& [p, q, r, s] = mesh.cells[c];
          of_cells[c] = integrals({mesh.vertices[p], mesh.vertices[q], mesh.vertices[r], mesh.vertices[s]});
        }
      });
  return of_cells;
}

}  // namespace

std::vector<CellValue> values_of_cells(const TetMesh& mesh, const ValueImage& image,
                                       const std::array<Rational, 12>& grid_to_mesh, ValuesOf of,
                                       int threads) {
  return std::visit(
      [&]<class Voxel>(const std::vector<Voxel>& values) {
        if (of == ValuesOf::kTrilinear)
          return values_of_cells(mesh, InterpolatedField<Voxel>(image, values), grid_to_mesh, threads);
        return values_of_cells(mesh, VoxelField<Voxel>(image, values), grid_to_mesh, threads);
      },
      image.values);
}

}  // namespace podm
