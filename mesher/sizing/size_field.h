// The radius bound r_t (rule R5): one circumradius per label, and less where a grid requests less.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "podm/label_image.h"
#include "sizing/size_grid.h"

namespace podm {

/// Cells stay below a grid's squared bound by this relative margin. The circumcenter of a nearly flat cell
/// has an error of up to 1e-9 of the cell's edges. The error of the bound is that error times the slope of
/// the bound.
inline constexpr double kGridMargin = 1e-6;

class SizeField {
 public:
  /// `radius_mm[label index]`; infinity where only the surface determines the size. `grid` is null if sizes
  /// depend on the label only.
  explicit SizeField(std::vector<double> radius_mm, std::shared_ptr<const SizeGrid> grid = nullptr)
      : grid_(std::move(grid)) {
    for (const double r : radius_mm) squared_.push_back(r * r);
    find_smallest();
  }
  /// All radii multiplied by `ratio`.
  SizeField scaled(double ratio) const {
    SizeField scaled = *this;
    for (double& squared : scaled.squared_) squared *= ratio * ratio;
    scaled.grid_ratio_ *= ratio;
    scaled.find_smallest();
    return scaled;
  }
  std::size_t num_labels() const { return squared_.size(); }  // includes the background
  bool has_grid() const { return grid_ != nullptr; }
  /// The bound on a cell of the label with its circumcenter at p.
  double squared_radius(LabelIndex label, const Point& p) const {
    return has_grid() ? std::min(squared_[label], squared_radius_of_grid(p)) : squared_[label];
  }
  double squared_radius_of_label(LabelIndex label) const { return squared_[label]; }
  /// There must be a grid.
  double squared_radius_of_grid(const Point& p) const {
    const double radius = grid_ratio_ * grid_->radius_at(p);
    return radius * radius;
  }
  /// The least bound at any point of the object, without the background.
  double smallest_squared_radius() const { return smallest_squared_; }

 private:
  void find_smallest() {
    smallest_squared_ = *std::min_element(squared_.begin() + 1, squared_.end());
    if (!has_grid()) return;
    const double of_grid = grid_ratio_ * grid_->least_radius_mm();
    smallest_squared_ = std::min(smallest_squared_, of_grid * of_grid);
  }

  std::vector<double> squared_;
  std::shared_ptr<const SizeGrid> grid_;
  double grid_ratio_ = 1;
  double smallest_squared_ = 0;
};

/// The bound on the cells of one label, for any circumcenter.
class LabelBound {
 public:
  LabelBound() = default;
  explicit constexpr LabelBound(double squared_radius) : squared_(squared_radius) {}
  LabelBound(const SizeField& sizes, LabelIndex label)
      : squared_(sizes.squared_radius_of_label(label)), sizes_(sizes.has_grid() ? &sizes : nullptr) {}

  /// No bound is larger.
  double most_squared() const { return squared_; }
  /// True if a squared radius that is at most most_squared() is within the bound at p.
  bool allows(double squared_radius, const Point& p) const {
    return sizes_ == nullptr || squared_radius < (1 - kGridMargin) * sizes_->squared_radius_of_grid(p);
  }

 private:
  double squared_ = 0;
  const SizeField* sizes_ = nullptr;  // null if there is no grid
};

}  // namespace podm
