// Two passes over the grid. Each pass looks at the neighbors that it has already passed. A shortest path may
// take its steps in any order: first all steps that go forward through the arrays, then all others.
// (Borgefors, "Distance transformations in digital images", 1986.)
#include "sizing/graded_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace podm {

namespace {

// One pass, forward or backward. A row is lowered by those of its neighbors that were passed, then along
// itself.
class Pass {
 public:
  Pass(const std::array<int, 3>& size, const std::array<double, 3>& spacing, double slope, bool is_forward,
       std::vector<float>& values)
      : size_(size), sign_(is_forward ? 1 : -1), values_(values) {
    for (int x = 0; x < 2; ++x)
      for (int y = 0; y < 2; ++y)
        for (int z = 0; z < 2; ++z)
          rises_[z][y][x] =
              static_cast<float>(slope * std::hypot(x * spacing[0], y * spacing[1], z * spacing[2]));
  }

  void operator()() {
    for (int k = 0; k < size_[2]; ++k)
      for (int j = 0; j < size_[1]; ++j) lower_row(from_start(j, 1), from_start(k, 2));
  }

 private:
  int from_start(int i, std::size_t axis) const { return sign_ > 0 ? i : size_[axis] - 1 - i; }
  float* row(int j, int k) {
    return values_.data() +
           (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size_[0]);
  }

  void lower_row(int j, int k) {
    float* const own = row(j, k);
    for (const auto& [dj, dk] :
         {std::array{-1, 0}, std::array{-1, -1}, std::array{0, -1}, std::array{1, -1}}) {
      const int y = j + sign_ * dj, z = k + sign_ * dk;
      if (y >= 0 && y < size_[1] && z >= 0 && z < size_[2])
        lower_by(row(y, z), rises_[dk != 0][dj != 0], own);
    }
    for (int i = 1; i < size_[0]; ++i) {
      float& value = own[from_start(i, 0)];
      value = std::min(value, own[from_start(i - 1, 0)] + rises_[0][0][1]);
    }
  }

  // The loops have no branch, so that they can be vectorised.
  void lower_by(const float* other, const std::array<float, 2>& rises, float* own) const {
    const auto [straight, across] = rises;
    const int last = size_[0] - 1;
    for (int i = 0; i <= last; ++i) own[i] = std::min(own[i], other[i] + straight);
    for (int i = 1; i <= last; ++i) own[i] = std::min(own[i], other[i - 1] + across);
    for (int i = 0; i < last; ++i) own[i] = std::min(own[i], other[i + 1] + across);
  }

  const std::array<int, 3> size_;
  const int sign_;
  std::vector<float>& values_;
  std::array<std::array<std::array<float, 2>, 2>, 2>
      rises_{};  // by the step's change along z, y and x (0 or 1)
};

}  // namespace

// Consider a straight path with na >= nb >= nc steps along the axes of spacings a, b, c. The shortest path
// over neighbors takes nc space diagonals, nb - nc diagonals of the first two axes, and na - nb steps along
// the first axis. Its length is linear in the extents of the straight path along the axes. Per length of the
// straight path it is therefore longest along the gradient of this linear function, where it equals the
// length of the gradient.
double graded_stretch(const std::array<double, 3>& spacing) {
  std::array<std::size_t, 3> axes{0, 1, 2};
  double most = 1;
  do {
    const double a = spacing[axes[0]], b = spacing[axes[1]], c = spacing[axes[2]];
    const double two = std::hypot(a, b), three = std::hypot(a, b, c);
    most = std::max(most, std::hypot(1.0, (two - a) / b, (three - two) / c));
  } while (std::next_permutation(axes.begin(), axes.end()));
  return most;
}

void grade(const std::array<int, 3>& size, const std::array<double, 3>& spacing, double slope,
           std::vector<float>& values) {
  const double slope_of_ways = slope / graded_stretch(spacing);
  for (const bool is_forward : {true, false}) Pass(size, spacing, slope_of_ways, is_forward, values)();
}

}  // namespace podm
