#include "sizing/scalar_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace podm {

ScalarGrid::ScalarGrid(const std::array<int, 3>& size, const Affine& to_nodes, Values values)
    : size_(size), to_nodes_(to_nodes), values_(std::move(values)) {
  const auto nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]);
  steps_ = {1, nx, nx * ny};
  for (std::size_t axis = 0; axis < 3; ++axis) across_[axis] = size[axis] > 1 ? steps_[axis] : 0;
}

namespace {

double between(double a, double b, double f) { return a + f * (b - a); }

}  // namespace

double ScalarGrid::at(const Point& p) const {
  const std::array<double, 3> u = map(to_nodes_, std::array<double, 3>{p.x, p.y, p.z});
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(u[axis] >= -0.5 - kSlack && u[axis] <= size_[axis] - 0.5 + kSlack)) return kNone;
  return between_nodes(u);
}

double ScalarGrid::at_nearest(const Point& p) const {
  const std::array<double, 3> u = map(to_nodes_, std::array<double, 3>{p.x, p.y, p.z});
  const auto is_finite = [](double x) { return std::isfinite(x); };
  return std::all_of(u.begin(), u.end(), is_finite) ? between_nodes(u) : kNone;
}

double ScalarGrid::between_nodes(const std::array<double, 3>& u) const {
  Place place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = size_[axis] - 1;
    const double inside = std::clamp(u[axis], 0.0, last);
    place.cell[axis] = std::min(static_cast<int>(inside), std::max(size_[axis] - 2, 0));
    place.fraction[axis] = inside - place.cell[axis];
    place.is_beyond[axis] = std::fabs(u[axis] - inside) > kSlack;
  }
  const float* const v = values_->data() + index(place.cell[0], place.cell[1], place.cell[2]);
  const auto& [x, y, z] = across_;
  const auto& f = place.fraction;
  const std::array<float, 8> n{v[0], v[x], v[y], v[x + y], v[z], v[x + z], v[y + z], v[x + y + z]};
  if (*std::min_element(n.begin(), n.end()) > 0) [[likely]]
    return between(between(between(n[0], n[1], f[0]), between(n[2], n[3], f[0]), f[1]),
                   between(between(n[4], n[5], f[0]), between(n[6], n[7], f[0]), f[1]), f[2]);
  return least_around(place);
}

double ScalarGrid::mean(const Place& place) const {
  const float* const v = values_->data() + index(place.cell[0], place.cell[1], place.cell[2]);
  double sum = 0, weights = 0;
  for (unsigned node = 0; node < 8; ++node) {
    double weight = 1;
    std::size_t at = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const bool is_upper = (node >> axis & 1) != 0;
      weight *= is_upper ? place.fraction[axis] : 1 - place.fraction[axis];
      at += is_upper ? across_[axis] : 0;
    }
    if (v[at] <= 0) continue;
    sum += weight * static_cast<double>(v[at]);
    weights += weight;
  }
  return weights > 0 ? sum / weights : kNone;
}

// The least mean on a cell's side and on both sides of it.
double ScalarGrid::least_around(const Place& place) const {
  std::vector<Place> places{place};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int cell = place.cell[axis];
    const double f = place.fraction[axis];
    const auto add = [&](int other_cell, double other_f) {
      if (other_cell < 0 || other_cell > size_[axis] - 2) return;
      const std::size_t count = places.size();
      for (std::size_t i = 0; i < count; ++i) {
        if (places[i].cell[axis] != cell || places[i].fraction[axis] != f) continue;
        Place other = places[i];
        other.cell[axis] = other_cell;
        other.fraction[axis] = other_f;
        places.push_back(other);
      }
    };
    if (place.is_beyond[axis]) continue;
    if (f < kSlack) {
      add(cell, 0);
      add(cell, kSlack);
      add(cell - 1, 1 - kSlack);
    } else if (f > 1 - kSlack) {
      add(cell, 1);
      add(cell, 1 - kSlack);
      add(cell + 1, kSlack);
    }
  }
  double least = kNone;
  for (const Place& each : places) least = std::min(least, mean(each));
  return least;
}

std::array<std::array<double, 2>, 3> ScalarGrid::node_bounds(const Box& box) const {
  std::array<std::array<double, 2>, 3> bounds;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double* const row = &to_nodes_[4 * axis];
    bounds[axis] = {row[3], row[3]};
    const std::array<std::array<double, 2>, 3> sides{
        {{box.low.x, box.high.x}, {box.low.y, box.high.y}, {box.low.z, box.high.z}}};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax({row[i] * sides[i][0], row[i] * sides[i][1]});
      bounds[axis][0] += low;
      bounds[axis][1] += high;
    }
  }
  return bounds;
}

ScalarGrid::Range ScalarGrid::range_in(const Box& box) const {
  std::array<int, 3> first, last;
  const auto bounds = node_bounds(box);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double most = size_[axis] - 1;
    first[axis] = static_cast<int>(std::clamp(std::floor(bounds[axis][0]) - 1, 0.0, most));
    last[axis] = static_cast<int>(std::clamp(std::ceil(bounds[axis][1]) + 1, 0.0, most));
  }
  Range range;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const double value = (*values_)[index(i, j, k)];
        if (value <= 0) continue;
        range.least = std::min(range.least, value);
        range.most = std::max(range.most, value);
      }
  return range;
}

// Two disjoint boxes that are not at an angle are separated by a side of one of them.
bool ScalarGrid::meets(const Box& box) const {
  const auto in_nodes = node_bounds(box);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (in_nodes[axis][1] < -0.5 || in_nodes[axis][0] > size_[axis] - 0.5) return false;
  const Affine to_points = inverse(to_nodes_);
  const std::array<std::array<double, 2>, 3> sides{
      {{box.low.x, box.high.x}, {box.low.y, box.high.y}, {box.low.z, box.high.z}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = to_points[4 * axis + 3], high = low;
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = to_points[4 * axis + i] * -0.5, b = to_points[4 * axis + i] * (size_[i] - 0.5);
      low += std::min(a, b);
      high += std::max(a, b);
    }
    if (high < sides[axis][0] || low > sides[axis][1]) return false;
  }
  return true;
}

}  // namespace podm
