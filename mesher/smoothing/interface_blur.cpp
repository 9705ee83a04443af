#include "smoothing/interface_blur.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace podm {

namespace {

constexpr double kReach = 3;  // widths
constexpr std::size_t kSide = kTileSide;

void add(double factor, const std::array<double, kSide>& source, double* target) {
  for (std::size_t x = 0; x < kSide; ++x) target[x] += factor * source[x];
}

}  // namespace

InterfaceBlur::Taps::Taps(double width_voxels) : reach(voxels_to_cover(kReach * width_voxels)), sums{0} {
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(std::exp(-0.5 * (i / width_voxels) * (i / width_voxels)));
  double sum = 0;
  for (const double weight : weights) sum += weight;
  for (double& weight : weights) {
    weight /= sum;
    sums.push_back(sums.back() + weight);
  }
}

double InterfaceBlur::Taps::sum_before(int position) const {
  return sums[unsigned_of(std::clamp(position, 0, 2 * reach + 1))];
}

InterfaceBlur::Gaussian InterfaceBlur::gaussian(const LabelImage& image, double width_mm) {
  return {Taps(width_mm / image.spacing[0]), Taps(width_mm / image.spacing[1]),
          Taps(width_mm / image.spacing[2])};
}

InterfaceBlur::InterfaceBlur(const LabelImage& image, double width_mm)
    : image_(image),
      width_mm_(width_mm),
      mm_per_lead_(width_mm * std::sqrt(2 * std::numbers::pi) / 3),
      narrow_(gaussian(image, width_mm)),
      wide_(gaussian(image, 2 * width_mm)) {
  for (std::size_t a = 0; a < 3; ++a) {
    halo_[a] = wide_[a].reach;
    window_[a] = kTileSide + 2 * halo_[a];
  }
}

// Reads the labels of the tile and of its halo, in runs. Beyond the image the labels are those at its border.
void InterfaceBlur::read_window(const Voxel& first, Scratch& scratch) const {
  scratch.runs.clear();
  scratch.first_run.clear();
  scratch.labels.clear();
  const auto inside = [&](int at, std::size_t a) { return std::clamp(at, 0, image_.size[a] - 1); };
  const auto count = [&](const Scratch::Run& run) {
    auto at = std::find_if(scratch.labels.begin(), scratch.labels.end(),
                           [&](const Scratch::Presence& known) { return known.label == run.label; });
    if (at == scratch.labels.end()) at = scratch.labels.insert(at, {run.label, 0});
    at->voxels += unsigned_of(run.end - run.begin);
  };
  for (int k = 0; k < window_[2]; ++k) {
    for (int j = 0; j < window_[1]; ++j) {
      const std::size_t at =
          image_.index(0, inside(first.j + j - halo_[1], 1), inside(first.k + k - halo_[2], 2));
      scratch.first_run.push_back(scratch.runs.size());
      for (int i = 0; i < window_[0]; ++i) {
        const LabelIndex label = image_.voxels[at + unsigned_of(inside(first.i + i - halo_[0], 0))];
        if (i == 0 || label != scratch.runs.back().label) scratch.runs.push_back({label, i, i});
        ++scratch.runs.back().end;
      }
      std::for_each(scratch.runs.begin() + static_cast<std::ptrdiff_t>(scratch.first_run.back()),
                    scratch.runs.end(), count);
    }
  }
  scratch.first_run.push_back(scratch.runs.size());
  std::sort(scratch.labels.begin(), scratch.labels.end(),
            [](const Scratch::Presence& a, const Scratch::Presence& b) {
              return a.voxels != b.voxels ? a.voxels < b.voxels : a.label < b.label;
            });
}

// Blurs the label's indicator along x, in the rows that the taps of the other axes reach. A run adds the sum
// of the taps from its begin to its end.
void InterfaceBlur::blur_rows(LabelIndex label, const Gaussian& gaussian, Scratch& scratch) const {
  const std::size_t num_y = kSide + gaussian[1].count() - 1, num_z = kSide + gaussian[2].count() - 1;
  scratch.by_x.resize(num_y * num_z);
  scratch.has_label.assign(num_y * num_z, false);
  for (std::size_t row = 0; row < scratch.by_x.size(); ++row) {
    const std::size_t j = row % num_y + unsigned_of(halo_[1] - gaussian[1].reach);
    const std::size_t k = row / num_y + unsigned_of(halo_[2] - gaussian[2].reach);
    const std::size_t at = k * unsigned_of(window_[1]) + j;
    scratch.by_x[row].fill(0);
    for (std::size_t r = scratch.first_run[at]; r < scratch.first_run[at + 1]; ++r) {
      const Scratch::Run& run = scratch.runs[r];
      if (run.label != label) continue;
      scratch.has_label[row] = true;
      const int first_tap = halo_[0] - gaussian[0].reach;
      for (int x = 0; x < kTileSide; ++x)
        scratch.by_x[row][unsigned_of(x)] += gaussian[0].sum_before(run.end - first_tap - x) -
                                             gaussian[0].sum_before(run.begin - first_tap - x);
    }
  }
}

// Adds `factor` times the blurred indicator to the label's weight in the tile, one axis after another.
void InterfaceBlur::blur(LabelIndex label, const Gaussian& gaussian, double factor, Scratch& scratch) const {
  blur_rows(label, gaussian, scratch);
  const std::size_t num_y = kSide + gaussian[1].count() - 1;
  scratch.by_xz.assign(kSide * num_y, {});
  for (std::size_t row = 0; row < scratch.by_x.size(); ++row) {
    if (!scratch.has_label[row]) continue;
    for (std::size_t z = 0; z < kSide; ++z) {
      const std::size_t tap = row / num_y - z;  // wraps around where there is no tap
      if (tap < gaussian[2].count())
        add(gaussian[2].weights[tap], scratch.by_x[row], scratch.by_xz[z * num_y + row % num_y].data());
    }
  }
  for (std::size_t z = 0; z < kSide; ++z)
    for (std::size_t y = 0; y < kSide; ++y)
      for (std::size_t tap = 0; tap < gaussian[1].count(); ++tap)
        add(factor * gaussian[1].weights[tap], scratch.by_xz[z * num_y + y + tap],
            &scratch.weight[place_in_tile(0, static_cast<int>(y), static_cast<int>(z))]);
}

// The weights of all labels add up to 1. The most frequent label is therefore not blurred.
void InterfaceBlur::weigh(LabelIndex label, Scratch& scratch) const {
  if (label == scratch.labels.back().label) {
    for (std::size_t at = 0; at < kTileVoxels; ++at) scratch.weight[at] = 1 - scratch.sum_of_weights[at];
    return;
  }
  scratch.weight.fill(0);
  blur(label, narrow_, 2, scratch);
  blur(label, wide_, -1, scratch);
  for (std::size_t at = 0; at < kTileVoxels; ++at) scratch.sum_of_weights[at] += scratch.weight[at];
}

void InterfaceBlur::compare(LabelIndex label, Scratch& scratch) const {
  for (int k = 0; k < kTileSide; ++k) {
    for (int j = 0; j < kTileSide; ++j) {
      const std::size_t row = unsigned_of(k + halo_[2]) * unsigned_of(window_[1]) + unsigned_of(j + halo_[1]);
      for (std::size_t r = scratch.first_run[row]; r < scratch.first_run[row + 1]; ++r) {
        const Scratch::Run& run = scratch.runs[r];
        const int begin = std::max(run.begin - halo_[0], 0), end = std::min(run.end - halo_[0], kTileSide);
        for (int i = begin; i < end; ++i) {
          const std::size_t at = place_in_tile(i, j, k);
          if (run.label == label)
            scratch.of_own[at] = scratch.weight[at];
          else
            scratch.of_others[at] = std::max(scratch.of_others[at], scratch.weight[at]);
        }
      }
    }
  }
}

const std::array<double, kTileVoxels>& InterfaceBlur::distances_mm(const Voxel& first,
                                                                   Scratch& scratch) const {
  read_window(first, scratch);
  scratch.sum_of_weights.fill(0);
  scratch.of_others.fill(0);  // the weight of labels that are not near
  for (const Scratch::Presence& near : scratch.labels) {
    weigh(near.label, scratch);
    compare(near.label, scratch);
  }
  for (std::size_t at = 0; at < kTileVoxels; ++at)
    scratch.distances[at] = mm_per_lead_ * (scratch.of_own[at] - scratch.of_others[at]);
  return scratch.distances;
}

}  // namespace podm
