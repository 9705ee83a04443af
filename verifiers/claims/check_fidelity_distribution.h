// Mean, 95 % and maximum of weighted distances, in mm and in voxels.
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace podm::verify {

/// Bins grow by 1 % above a hundredth. A percentile is its bin's upper end, at most about 1 % (and 0.0001)
/// too large.
class Distribution {
 public:
  void add(double value, double weight) {
    weight_ += weight;
    sum_ += weight * value;
    maximum_ = std::max(maximum_, value);
    bins_[bin(value)] += weight;
  }
  void add(const Distribution& other) {
    weight_ += other.weight_;
    sum_ += other.sum_;
    maximum_ = std::max(maximum_, other.maximum_);
    for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  }
  bool empty() const { return weight_ == 0; }
  double mean() const { return sum_ / weight_; }
  double maximum() const { return maximum_; }
  double percentile(double fraction) const {
    double below = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      below += bins_[i];
      if (below >= fraction * weight_) return std::min(maximum_, upper_end(i));
    }
    return maximum_;
  }

 private:
  static constexpr double kPerUnit = 100, kPerDoubling = 70;
  static std::size_t bin(double value) {
    return std::min(kBins - 1, static_cast<std::size_t>(kPerDoubling * std::log2(1 + kPerUnit * value)));
  }
  static double upper_end(std::size_t i) {
    return (std::exp2(static_cast<double>(i + 1) / kPerDoubling) - 1) / kPerUnit;
  }
  static constexpr std::size_t kBins = 1600;  // up to 7 10^4
  double weight_ = 0, sum_ = 0, maximum_ = 0;
  std::array<double, kBins> bins_{};
};

struct Distances {
  Distribution mm, voxels;

  void add(double in_mm, double in_voxels, double weight) {
    mm.add(in_mm, weight);
    voxels.add(in_voxels, weight);
  }
  void add(const Distances& other) {
    mm.add(other.mm);
    voxels.add(other.voxels);
  }
  nlohmann::json to_json() const {
    if (mm.empty()) return nullptr;
    return {{"mean_mm", mm.mean()},
            {"p95_mm", mm.percentile(0.95)},
            {"max_mm", mm.maximum()},
            {"mean_voxels", voxels.mean()},
            {"p95_voxels", voxels.percentile(0.95)},
            {"max_voxels", voxels.maximum()}};
  }
};

}  // namespace podm::verify
