#include "image/label_function.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace podm::verify {

namespace {

// Returns the trilinear weight at f of corner x + 2y + 4z.
double corner_weight(std::size_t corner, const Point& f) {
  return ((corner & 1) != 0 ? f[0] : 1 - f[0]) * ((corner & 2) != 0 ? f[1] : 1 - f[1]) *
         ((corner & 4) != 0 ? f[2] : 1 - f[2]);
}

std::array<double, 8> all_corner_weights(const Point& f) {
  std::array<double, 8> weights;
  for (std::size_t c = 0; c < 8; ++c) weights[c] = corner_weight(c, f);
  return weights;
}

bool is_uniform(const std::array<std::uint32_t, 8>& corners) {
  return std::all_of(corners.begin() + 1, corners.end(), [&](std::uint32_t l) { return l == corners[0]; });
}

}  // namespace

double LabelWeights::weight_of(std::uint32_t label) const {
  for (std::size_t i = 0; i < count; ++i)
    if (labels[i] == label) return weights[i];
  return 0;
}

std::size_t LabelWeights::best() const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (weights[i] > weights[best] || (weights[i] == weights[best] && labels[i] < labels[best])) best = i;
  return best;
}

LabelFunction::LabelFunction(const Image& image)
    : LabelFunction(image, image.smoothing ? &*image.smoothing : nullptr) {}

LabelFunction LabelFunction::of_voxels(const Image& image) { return {image, nullptr}; }

LabelFunction::LabelFunction(const Image& image, const Smoothing* smoothing)
    : image_(image),
      smoothing_(smoothing),
      row_(static_cast<std::size_t>(image.size[0])),
      slice_(row_ * static_cast<std::size_t>(image.size[1])) {}

// At a voxel or more from the grid all eight voxels are background.
bool LabelFunction::is_near(const Point& u) const {
  if (image_.is_box_flat) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(u[axis] >= -0.5 && u[axis] <= image_.size[axis] - 0.5)) return false;
    return true;
  }
  return u[0] > -1 && u[0] < image_.size[0] && u[1] > -1 && u[1] < image_.size[1] && u[2] > -1 &&
         u[2] < image_.size[2];
}

// With a flat box returns the nearest point between the centers of voxels.
Point LabelFunction::in_grid(const Point& u) const {
  if (!image_.is_box_flat) return u;
  Point inside;
  for (std::size_t axis = 0; axis < 3; ++axis)
    inside[axis] = std::clamp(u[axis], 0.0, image_.size[axis] - 1.0);
  return inside;
}

bool LabelFunction::is_at_side(const Point& u, double reach) const {
  for (std::size_t axis = 0; image_.is_box_flat && axis < 3; ++axis)
    if (std::abs(u[axis] + 0.5) <= reach || std::abs(u[axis] - (image_.size[axis] - 0.5)) <= reach)
      return true;
  return false;
}

LabelFunction::Place LabelFunction::place(const Point& u) {
  Place p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(u[axis]);
    p.block[axis] = static_cast<int>(floor);
    p.f[axis] = u[axis] - floor;
  }
  return p;
}

bool LabelFunction::is_inside(const std::array<int, 3>& b) const {
  const auto& n = image_.size;
  return b[0] >= 0 && b[1] >= 0 && b[2] >= 0 && b[0] < n[0] - 1 && b[1] < n[1] - 1 && b[2] < n[2] - 1;
}

template <class Value>
std::array<Value, 8> LabelFunction::eight(const std::vector<Value>& grid, const std::array<int, 3>& b) const {
  const Value* first = grid.data() + static_cast<std::size_t>(b[2]) * slice_ +
                       static_cast<std::size_t>(b[1]) * row_ + static_cast<std::size_t>(b[0]);
  return {first[0],      first[1],          first[row_],          first[row_ + 1],
          first[slice_], first[slice_ + 1], first[slice_ + row_], first[slice_ + row_ + 1]};
}

std::array<std::uint32_t, 8> LabelFunction::corners(const std::array<int, 3>& b) const {
  if (is_inside(b)) return eight(image_.voxels, b);
  std::array<std::uint32_t, 8> labels{};
  const auto& n = image_.size;
  for (int c = 0; c < 8; ++c) {
    int i = b[0] + (c & 1), j = b[1] + (c >> 1 & 1), k = b[2] + (c >> 2);
    if (image_.is_box_flat) {
      i = std::clamp(i, 0, n[0] - 1);
      j = std::clamp(j, 0, n[1] - 1);
      k = std::clamp(k, 0, n[2] - 1);
    }
    if (i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2])
      labels[static_cast<std::size_t>(c)] =
          image_.voxels[static_cast<std::size_t>(k) * slice_ + static_cast<std::size_t>(j) * row_ +
                        static_cast<std::size_t>(i)];
  }
  return labels;
}

std::array<std::uint16_t, 8> LabelFunction::voxel_weights(const std::array<int, 3>& b) const {
  if (smoothing_ != nullptr && is_inside(b)) return eight(smoothing_->voxel_weights, b);
  std::array<std::uint16_t, 8> voxel_weights{};
  for (int c = 0; c < 8; ++c)
    voxel_weights[static_cast<std::size_t>(c)] =
        voxel_weight({b[0] + (c & 1), b[1] + (c >> 1 & 1), b[2] + (c >> 2)});
  return voxel_weights;
}

// Beyond the grid returns the weight of the nearest voxel inside.
std::uint16_t LabelFunction::voxel_weight(const std::array<int, 3>& voxel) const {
  if (smoothing_ == nullptr) return kFullVoxelWeight;
  const auto inside = [&](std::size_t axis) {
    return static_cast<std::size_t>(std::clamp(voxel[axis], 0, image_.size[axis] - 1));
  };
  return smoothing_->voxel_weights[inside(2) * slice_ + inside(1) * row_ + inside(0)];
}

double LabelFunction::change_after(const std::array<int, 3>& voxel, std::size_t axis) const {
  std::array<int, 3> next = voxel;
  ++next[axis];
  const double first = voxel_weight(voxel), second = voxel_weight(next);
  return first / (first + second);
}

std::array<double, 8> LabelFunction::smoothed(std::array<double, 8> corner_weights,
                                              const std::array<int, 3>& block) const {
  const auto voxel_weights = this->voxel_weights(block);
  for (std::size_t c = 0; c < 8; ++c) corner_weights[c] *= voxel_weights[c] * (1.0 / kFullVoxelWeight);
  return corner_weights;
}

std::uint32_t LabelFunction::label_at(const Point& u) const {
  const LabelWeights weights = weights_at(u);
  return weights.labels[weights.best()];
}

// Along each axis the factors of a weight are multiplied by the coordinate's denominator, so that all of them
// are integers. This multiplies all weights by the same number.
std::uint32_t LabelFunction::exact_label_at(const std::array<mpq_class, 3>& at) const {
  std::array<mpq_class, 3> u = at;
  for (std::size_t axis = 0; image_.is_box_flat && axis < 3; ++axis) {
    const mpq_class last(image_.size[axis] - 1), half(1, 2);
    if (u[axis] < -half || u[axis] > last + half) return 0;
    u[axis] = std::clamp(u[axis], mpq_class(0), last);
  }
  std::array<int, 3> block{};
  std::array<std::array<mpz_class, 2>, 3> factors;  // of the lower and the upper voxel along each axis
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (u[axis] <= -1 || u[axis] >= image_.size[axis]) return 0;
    mpz_class floor;
    mpz_fdiv_qr(floor.get_mpz_t(), factors[axis][1].get_mpz_t(), u[axis].get_num_mpz_t(),
                u[axis].get_den_mpz_t());
    block[axis] = static_cast<int>(floor.get_si());
    factors[axis][0] = u[axis].get_den() - factors[axis][1];
  }
  const auto labels = corners(block);
  const auto voxel_weights = this->voxel_weights(block);
  std::map<std::uint32_t, mpz_class> weights;  // by label: the first of the greatest wins
  for (std::size_t c = 0; c < 8; ++c)
    weights[labels[c]] += voxel_weights[c] * factors[0][c & 1] * factors[1][c >> 1 & 1] * factors[2][c >> 2];
  auto best = weights.begin();
  for (auto w = weights.begin(); w != weights.end(); ++w)
    if (w->second > best->second) best = w;
  return best->first;
}

std::uint32_t LabelFunction::decided_label_at(const Point& u, std::uint64_t& num_exact) const {
  const LabelWeights weights = weights_at(u);
  const std::size_t best = weights.best();
  for (std::size_t i = 0; i < weights.count; ++i)
    if (i != best && !(weights.weights[best] - weights.weights[i] > 2.1 * kWeightError)) {
      ++num_exact;
      return exact_label_at({mpq_class(u[0]), mpq_class(u[1]), mpq_class(u[2])});
    }
  return weights.labels[best];
}

LabelWeights LabelFunction::weights_at(const Point& u) const {
  LabelWeights result;
  if (!is_near(u)) {
    result.weights[0] = 1;
    result.count = 1;
    return result;
  }
  const Place p = place(in_grid(u));
  const auto labels = corners(p.block);
  if (is_uniform(labels)) {
    result.labels[0] = labels[0];
    result.weights[0] = 1;
    result.count = 1;
    return result;
  }
  std::array<double, 8> weights = all_corner_weights(p.f);
  if (smoothing_ != nullptr) weights = smoothed(weights, p.block);
  for (std::size_t c = 0; c < 8; ++c) {
    std::size_t i = 0;
    while (i < result.count && result.labels[i] != labels[c]) ++i;
    if (i == result.count) result.labels[result.count++] = labels[c];
    result.weights[i] += weights[c];
  }
  return result;
}

Point LabelFunction::gradient_of_difference(const Point& u, std::uint32_t a, std::uint32_t b) const {
  Point gradient{};
  if (!is_near(u)) return gradient;
  const Place p = place(in_grid(u));
  const auto labels = corners(p.block);
  std::array<double, 8> at_corners{1, 1, 1, 1, 1, 1, 1, 1};
  if (smoothing_ != nullptr) at_corners = smoothed(at_corners, p.block);
  for (std::size_t c = 0; c < 8; ++c) {
    const double slope = labels[c] == a ? at_corners[c] : labels[c] == b ? -at_corners[c] : 0;
    if (slope == 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Point unit = p.f;
      const bool is_high = (c >> axis & 1) != 0;
      unit[axis] = is_high ? 1 : 0;  // the factor of this axis becomes 1
      if (in_grid(u)[axis] == u[axis]) gradient[axis] += (is_high ? slope : -slope) * corner_weight(c, unit);
    }
  }
  return gradient;
}

}  // namespace podm::verify
