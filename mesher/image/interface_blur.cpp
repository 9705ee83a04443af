#include "image/interface_blur.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace podm {

namespace {

constexpr double kReach = 3;  // widths

std::size_t count(int n) { return static_cast<std::size_t>(n); }

// target[n] += factor * source[n]
template <class Number>
void add(double factor, const Number* source, std::size_t size, double* target) {
  for (std::size_t n = 0; n < size; ++n) target[n] += factor * static_cast<double>(source[n]);
}

}  // namespace

InterfaceBlur::Taps InterfaceBlur::taps(double width_voxels) {
  Taps taps{.reach = static_cast<int>(std::ceil(kReach * width_voxels)), .weights = {}};
  double sum = 0;
  for (int i = -taps.reach; i <= taps.reach; ++i) {
    taps.weights.push_back(std::exp(-0.5 * (i / width_voxels) * (i / width_voxels)));
    sum += taps.weights.back();
  }
  for (double& weight : taps.weights) weight /= sum;
  return taps;
}

InterfaceBlur::InterfaceBlur(const LabelImage& image, double width_mm)
    : image_(image), width_mm_(width_mm), mm_per_lead_(width_mm * std::sqrt(2 * std::numbers::pi) / 3) {
  for (std::size_t a = 0; a < 3; ++a) {
    narrow_[a] = taps(width_mm / image.spacing[a]);
    wide_[a] = taps(2 * width_mm / image.spacing[a]);
    halo_[a] = wide_[a].reach;
    window_[a] = kTileSide + 2 * halo_[a];
  }
}

// The labels of the tile and of its halo; beyond the image, those at its border.
void InterfaceBlur::read_window(const Voxel& first, Desk& desk) const {
  desk.window.clear();
  desk.labels.clear();
  const auto inside = [&](int at, std::size_t a) { return std::clamp(at, 0, image_.size[a] - 1); };
  LabelIndex last = kBackground;
  for (int k = 0; k < window_[2]; ++k) {
    for (int j = 0; j < window_[1]; ++j) {
      const LabelIndex* row =
          &image_
               .voxels[image_.index(0, inside(first.j + j - halo_[1], 1), inside(first.k + k - halo_[2], 2))];
      for (int i = 0; i < window_[0]; ++i) {
        const LabelIndex label = row[inside(first.i + i - halo_[0], 0)];
        desk.window.push_back(label);
        if (label == last && !desk.labels.empty()) continue;
        last = label;
        if (std::find(desk.labels.begin(), desk.labels.end(), label) == desk.labels.end())
          desk.labels.push_back(label);
      }
    }
  }
}

// Adds `factor` times the blurred indicator to the label's weight in the tile, an axis after the other.
void InterfaceBlur::blur(const std::array<Taps, 3>& gaussian, double factor, Desk& desk) const {
  const std::size_t row = count(window_[0]), plane = row * count(window_[1]), side = count(kTileSide);
  desk.by_z.assign(plane * side, 0);
  desk.by_yz.assign(row * side * side, 0);
  // Where the first voxel's first tap lies.
  const auto begin = [&](std::size_t a) { return count(halo_[a] - gaussian[a].reach); };
  for (std::size_t k = begin(2); k < begin(2) + side + gaussian[2].weights.size() - 1; ++k) {
    const float* source = &desk.indicator[k * plane];
    if (std::find(source, source + plane, 1.0f) == source + plane) continue;
    for (std::size_t z = 0; z < side; ++z) {
      const std::size_t tap = k - begin(2) - z;  // wraps around where there is none
      if (tap < gaussian[2].weights.size())
        add(gaussian[2].weights[tap], source, plane, &desk.by_z[z * plane]);
    }
  }
  for (std::size_t z = 0; z < side; ++z) {
    for (std::size_t y = 0; y < side; ++y) {
      double* blurred = &desk.by_yz[(z * side + y) * row];
      for (std::size_t tap = 0; tap < gaussian[1].weights.size(); ++tap)
        add(gaussian[1].weights[tap], &desk.by_z[z * plane + (begin(1) + y + tap) * row], row, blurred);
      double* weight = &desk.weight[(z * side + y) * side];
      for (std::size_t tap = 0; tap < gaussian[0].weights.size(); ++tap)
        add(factor * gaussian[0].weights[tap], blurred + begin(0) + tap, side, weight);
    }
  }
}

const std::array<double, kTileVoxels>& InterfaceBlur::distances_mm(const Voxel& first, Desk& desk) const {
  read_window(first, desk);
  desk.of_own.fill(0);
  desk.of_others.fill(0);  // that of labels which are not near
  desk.indicator.resize(desk.window.size());
  const std::size_t row = count(window_[0]), plane = row * count(window_[1]);
  for (const LabelIndex label : desk.labels) {
    std::transform(desk.window.begin(), desk.window.end(), desk.indicator.begin(),
                   [&](LabelIndex l) { return l == label ? 1.0f : 0.0f; });
    desk.weight.fill(0);
    blur(narrow_, 2, desk);
    blur(wide_, -1, desk);
    for (int k = 0; k < kTileSide; ++k) {
      for (int j = 0; j < kTileSide; ++j) {
        const LabelIndex* labels =
            &desk.window[count(k + halo_[2]) * plane + count(j + halo_[1]) * row + count(halo_[0])];
        for (int i = 0; i < kTileSide; ++i) {
          const std::size_t at = place_in_tile(i, j, k);
          if (labels[i] == label)
            desk.of_own[at] = desk.weight[at];
          else
            desk.of_others[at] = std::max(desk.of_others[at], desk.weight[at]);
        }
      }
    }
  }
  for (std::size_t at = 0; at < kTileVoxels; ++at)
    desk.distances[at] = mm_per_lead_ * (desk.of_own[at] - desk.of_others[at]);
  return desk.distances;
}

}  // namespace podm
