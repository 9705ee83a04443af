#include "claims/size_field.h"

#include <cmath>
#include <limits>

#include "geometry/circumcenter.h"

namespace podm::verify {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Position of a coordinate among `size` voxel centers: the first of two, and the fraction of the way to the
// second.
template <class T>
struct Place {
  int first;
  T fraction;
  bool is_outside = false;
};

// Returns nothing if the interval leaves the place open.
template <class T>
std::optional<Place<T>> place_of(const T& u, int size) {
  const double last = size - 1;
  if (high(u) < -0.5 || low(u) > last + 0.5) return Place<T>{0, T(0), true};
  if (low(u) < -0.5 || high(u) > last + 0.5) return std::nullopt;
  if (high(u) <= 0) return Place<T>{0, T(0)};
  if (low(u) >= last) return Place<T>{size - 1, T(0)};
  if (low(u) < 0 || high(u) > last || std::floor(low(u)) != std::floor(high(u))) return std::nullopt;
  const double first = std::floor(low(u));
  return Place<T>{static_cast<int>(first), u - T(first)};
}

// A rational is compared as it is; the double nearest to it may belong to another voxel.
template <>
std::optional<Place<Rational>> place_of(const Rational& u, int size) {
  const Rational half(1, 2), last(size - 1);
  if (u < -half || u > last + half) return Place<Rational>{0, Rational(0), true};
  if (u <= 0) return Place<Rational>{0, Rational(0)};
  if (u >= last) return Place<Rational>{size - 1, Rational(0)};
  int first = static_cast<int>(std::floor(CGAL::to_double(u)));
  while (Rational(first) > u) --first;
  while (Rational(first + 1) <= u) ++first;
  return Place<Rational>{first, u - Rational(first)};
}

}  // namespace

SizeField::SizeField(const SizeImage& image, double factor, Space space)
    : image_(image), factor_(Rational(factor)), to_voxels_(image.voxel_to_ras, space) {}

template <class T>
std::optional<SizeField::Mean<T>> SizeField::mean_at(const Vector<T>& voxel) const {
  std::array<Place<T>, 3> places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto place = place_of<T>(voxel[axis], image_.size[axis]);
    if (!place) return std::nullopt;
    places[axis] = *place;
  }
  Mean<T> mean{T(0), T(0)};
  if (places[0].is_outside || places[1].is_outside || places[2].is_outside) return mean;
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::size_t number = 0;
    T weight(1);
    bool is_in_grid = true;
    for (std::size_t axis = 3; axis-- > 0;) {
      const int step = static_cast<int>(corner >> axis & 1), at = places[axis].first + step;
      is_in_grid = is_in_grid && at < image_.size[axis];  // otherwise the weight is 0
      weight = weight * (step == 1 ? places[axis].fraction : T(1) - places[axis].fraction);
      number = number * static_cast<std::size_t>(image_.size[axis]) + static_cast<std::size_t>(at);
    }
    if (!is_in_grid || image_.radius_mm[number] == 0) continue;
    mean.sum = mean.sum + weight * T(static_cast<double>(image_.radius_mm[number]));
    mean.weights = mean.weights + weight;
  }
  return mean;
}

// Returns by how much R^2 exceeds the squared bound, times positive numbers; -1 if there is no bound.
template <class T>
T SizeField::excess(const CellPoints& p) const {
  const auto center = circumcenter<T>(p);
  const auto mean = center ? mean_at<T>(to_voxels_(*center)) : std::nullopt;
  if constexpr (std::is_same_v<T, Interval>) {
    if (!mean) return {-1, 1};
    if (low(mean->weights) <= 0 && high(mean->weights) > 0) return {-1, 1};
  } else {
    if (!mean) return T(-1);
  }
  if (mean->weights == T(0)) return T(-1);
  const T bound = factor_.template in<T>() * mean->sum;
  const Fraction<T> r2 = squared_circumradius<T>(p);
  return r2.numerator * mean->weights * mean->weights - bound * bound * r2.denominator;
}

bool SizeField::is_over(const CellPoints& p, std::uint64_t& num_exact) const {
  return sign_of([&]<class T>(T) { return excess<T>(p); }, num_exact) > 0;
}

double SizeField::bound_at(const Point& voxel) const {
  if (!std::isfinite(voxel[0] + voxel[1] + voxel[2])) return kUnbounded;
  const auto mean = mean_at<double>(voxel);
  return mean->weights > 0 ? CGAL::to_double(factor_.in<Interval>()) * mean->sum / mean->weights : kUnbounded;
}

double SizeField::bound_at_center(const CellPoints& p) const {
  const CGAL::Protect_FPU_rounding<true> rounding_upwards;
  const auto center = circumcenter<Interval>(p);
  if (!center) return kUnbounded;
  const Vector<Interval> voxel = to_voxels_(*center);
  return bound_at({CGAL::to_double(voxel[0]), CGAL::to_double(voxel[1]), CGAL::to_double(voxel[2])});
}

}  // namespace podm::verify
