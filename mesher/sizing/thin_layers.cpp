#include "sizing/thin_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "image/components.h"
#include "image/label_depths.h"
#include "image/working_frame.h"
#include "podm/errors.h"
#include "sizing/graded_grid.h"

namespace podm {

namespace {

// Slack added to the radius of a ball, relative to the shortest side of a voxel, as in thin_parts.cpp.
constexpr double kSlackOverSide = 0.4;
constexpr double kRounding = 1e-5;
constexpr double kLevelStep = 0.7071;  // from one tried delta to the next
constexpr float kNoBall = std::numeric_limits<float>::infinity();

class Layers {
 public:
  Layers(const LabelImage& image, DeltasAtVoxels& deltas, int threads)
      : image_(image),
        deltas_(deltas),
        threads_(threads),
        longest_mm_(*std::max_element(image.spacing.begin(), image.spacing.end())),
        shortest_mm_(*std::min_element(image.spacing.begin(), image.spacing.end())),
        depths_(image, static_cast<float>(most_mm() * most_mm()), threads, DepthsOf::kAllLabels) {
    find_label_depths(depths_, most_mm());
  }

  void operator()(std::uint64_t& num_voxels, std::optional<ThinnestPlace>& thinnest) {
    select();
    num_voxels = static_cast<std::uint64_t>(std::count(is_layer_.begin(), is_layer_.end(), 1));
    if (num_voxels == 0) return;
    for (double delta_mm = deltas_.most_mm(); lower_beyond(delta_mm); delta_mm *= kLevelStep) {
    }
    lower_by_runs(thinnest);
  }

 private:
  double depth_of_most_mm() const { return kDeltaOverThickness * std::max(deltas_.most_mm(), longest_mm_); }
  // From voxel to voxel the depth grows by at most a side.
  double most_mm() const { return depth_of_most_mm() + longest_mm_; }

  // The union of the balls of voxels of this depth or more: positive outside.
  VoxelField balls_of_depth(double least_mm) const {
    VoxelField balls(image_, kNoBall, threads_, DepthsOf::kAllLabels);
    const double slack_mm = kSlackOverSide * shortest_mm_;
    const auto squared_least = static_cast<float>(least_mm * least_mm * (1 - kRounding));
    for (std::size_t i = 0; i < image_.voxels.size(); ++i)
      if (depths_[i] >= squared_least) {
        const float radius = std::sqrt(depths_[i]) + static_cast<float>(slack_mm);
        balls[i] = -radius * radius;
      }
    unite_balls(balls, most_mm() + slack_mm);
    return balls;
  }
  bool is_beyond(const VoxelField& balls, std::size_t voxel) const {
    return balls[voxel] > kRounding * shortest_mm_ * shortest_mm_;
  }

  // Marks the voxels of the parts that are kept.
  void select() {
    const VoxelField balls = balls_of_depth(depth_of_most_mm());
    LabelImage thin, thick;
    thin.size = thick.size = image_.size;
    thin.voxels.resize(image_.voxels.size());
    thick.voxels.resize(image_.voxels.size());
    for (std::size_t i = 0; i < image_.voxels.size(); ++i)
      (is_beyond(balls, i) ? thin : thick).voxels[i] = static_cast<LabelIndex>(image_.voxels[i] + 1);
    const Components parts(thin), pieces(thick);
    std::vector<char> is_kept(parts.size());
    std::vector<std::set<Components::Id>> beside(parts.size());
    steps_.assign(image_.voxels.size(), 0);
    std::vector<std::size_t> front;
    parts.for_each_run([&](Components::Id part, const Voxel& first, int length) {
      if (parts[part].label == 0) return;
      for (Voxel v = first; v.i < first.i + length; ++v.i)
        for_each_beside(v, [&](const Voxel& other) {
          const std::size_t at = index(v);
          if (thick.voxels[index(other)] != thin.voxels[at]) return;
          if (beside[part].size() < 2) beside[part].insert(pieces.of(other));
          if (steps_[at] == 0) front.push_back(at);
          steps_[at] = 1;
        });
    });
    for (Components::Id part = 0; part < parts.size(); ++part)
      is_kept[part] = parts[part].label != 0 && beside[part].size() != 1;
    for (const std::size_t far : walk_from(std::move(front), thin)) is_kept[parts.of(voxel(far))] = 1;
    is_layer_.assign(image_.voxels.size(), 0);
    parts.for_each_run([&](Components::Id part, const Voxel& first, int length) {
      if (is_kept[part] != 0)
        std::fill_n(is_layer_.begin() + static_cast<std::ptrdiff_t>(index(first)), length, 1);
    });
    steps_ = {};
  }

  // Counts steps from the thick pieces into the thin parts. Returns voxels farther than delta from them.
  std::vector<std::size_t> walk_from(std::vector<std::size_t> front, const LabelImage& thin) {
    const int most_steps = std::min(static_cast<int>(std::ceil(deltas_.most_mm() / shortest_mm_)) + 1, 250);
    for (int step = 1; step < most_steps && !front.empty(); ++step) {
      std::vector<std::size_t> next;
      for (const std::size_t at : front)
        for_each_beside(voxel(at), [&](const Voxel& other) {
          const std::size_t to = index(other);
          if (thin.voxels[to] != thin.voxels[at] || steps_[to] != 0) return;
          steps_[to] = static_cast<std::uint8_t>(step + 1);
          next.push_back(to);
        });
      front = std::move(next);
    }
    return front;
  }

  // Lowers the delta of layers that are beyond the balls which this delta needs. Returns false if no ball is
  // smaller.
  bool lower_beyond(double delta_mm) {
    const double depth_mm = kDeltaOverThickness * delta_mm - shortest_mm_ / 2;
    if (depth_mm <= shortest_mm_ / 2) return false;
    const VoxelField balls = balls_of_depth(depth_mm);
    const double lower_mm = delta_mm * kLevelStep;
    bool is_any = false;
    for (std::size_t i = 0; i < image_.voxels.size(); ++i)
      if (is_layer_[i] != 0 && is_beyond(balls, i)) is_any = deltas_.lower(i, lower_mm) || is_any;
    return is_any;
  }

  void lower_by_runs(std::optional<ThinnestPlace>& thinnest) {
    for (std::size_t i = 0; i < image_.voxels.size(); ++i) {
      if (is_layer_[i] == 0) continue;
      const Voxel v = voxel(i);
      const double run_mm = shortest_run_mm(v);
      deltas_.lower(i, kDeltaOverThickness * run_mm);
      const double thickness_mm = std::min(run_mm, deltas_.at(i) / kDeltaOverThickness);
      if (!thinnest || thickness_mm < thinnest->thickness_mm * (1 - kRounding))
        thinnest = {image_.voxels[i], v, thickness_mm};
    }
  }

  double shortest_run_mm(const Voxel& v) const {
    double shortest = std::numeric_limits<double>::infinity();
    const LabelIndex label = image_.voxels[index(v)];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double side_mm = image_.spacing[axis];
      double run_mm = side_mm;
      for (const int sign : {-1, 1})
        for (Voxel w = moved(v, axis, sign); run_mm < shortest && label_at(w) == label;
             w = moved(w, axis, sign)) {
          run_mm += side_mm;
          if (!is_inside(w)) run_mm = shortest;  // the background goes on
        }
      shortest = std::min(shortest, run_mm);
    }
    return shortest;
  }

  static Voxel moved(Voxel v, std::size_t axis, int step) {
    (axis == 0 ? v.i : axis == 1 ? v.j : v.k) += step;
    return v;
  }
  bool is_inside(const Voxel& v) const {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < image_.size[0] && v.j < image_.size[1] &&
           v.k < image_.size[2];
  }
  std::size_t index(const Voxel& v) const { return image_.index(v.i, v.j, v.k); }
  LabelIndex label_at(const Voxel& v) const { return is_inside(v) ? image_.voxels[index(v)] : kBackground; }
  Voxel voxel(std::size_t at) const {
    const auto nx = static_cast<std::size_t>(image_.size[0]), ny = static_cast<std::size_t>(image_.size[1]);
    return {static_cast<int>(at % nx), static_cast<int>(at / nx % ny), static_cast<int>(at / nx / ny)};
  }
  template <class Visit>
  void for_each_beside(const Voxel& v, const Visit& visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1})
        if (const Voxel other = moved(v, axis, sign); is_inside(other)) visit(other);
  }

  const LabelImage& image_;
  DeltasAtVoxels& deltas_;
  int threads_;
  double longest_mm_, shortest_mm_;
  VoxelField depths_;
  std::vector<std::uint8_t> steps_;
  std::vector<char> is_layer_;
};

std::string name_of(const Label& label) {
  return label.name.empty() ? fmt::format("label {}", label.value)
                            : fmt::format("label {} ({})", label.value, label.name);
}

}  // namespace

DeltasAtVoxels::DeltasAtVoxels(const LabelImage& image, double least_mm, double most_mm)
    : image_(&image),
      least_mm_(least_mm),
      most_mm_(most_mm),
      deltas_mm_(image.voxels.size(), static_cast<float>(most_mm)) {}

bool DeltasAtVoxels::lower(std::size_t voxel, double delta_mm) {
  const auto to = static_cast<float>(std::max(delta_mm, least_mm_));
  if (!(to < deltas_mm_[voxel])) return false;
  deltas_mm_[voxel] = to;
  return true;
}

std::shared_ptr<const DeltaField> DeltasAtVoxels::graded() {
  const double slope = DeltaField::kSlope * graded_stretch(image_->spacing) / std::sqrt(3.0);
  grade(image_->size, image_->spacing, slope, deltas_mm_);
  ScalarGrid grid(image_->size, inverse(voxels_to_working(*image_)),
                  std::make_shared<const std::vector<float>>(deltas_mm_));
  return std::make_shared<const DeltaField>(std::move(grid), least_mm_, most_mm_);
}

std::vector<DeltaShare> shares_of_deltas(const LabelImage& image, const DeltasAtVoxels& deltas) {
  constexpr double kSteps = 4;  // in a power of two
  std::map<long, double> area_mm2;
  double all_mm2 = 0;
  const std::array<std::size_t, 3> step{1, image.index(0, 1, 0), image.index(0, 0, 1)};
  std::size_t voxel = 0;
  for (int k = 0; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j)
      for (int i = 0; i < image.size[0]; ++i, ++voxel) {
        const std::array<bool, 3> has_next{i + 1 < image.size[0], j + 1 < image.size[1],
                                           k + 1 < image.size[2]};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::size_t next = voxel + step[axis];
          const LabelIndex across = has_next[axis] ? image.voxels[next] : kBackground;
          if (across == image.voxels[voxel]) continue;
          const double delta_mm =
              has_next[axis] ? std::min(deltas.at(voxel), deltas.at(next)) : deltas.at(voxel);
          const double face_mm2 = image.spacing[(axis + 1) % 3] * image.spacing[(axis + 2) % 3];
          area_mm2[std::lround(kSteps * std::log2(deltas.most_mm() / delta_mm))] += face_mm2;
          all_mm2 += face_mm2;
        }
      }
  std::vector<DeltaShare> shares;
  for (const auto& [steps, mm2] : area_mm2)
    shares.push_back({deltas.most_mm() * std::exp2(-static_cast<double>(steps) / kSteps), mm2 / all_mm2});
  return shares;
}

double least_delta_mm(const LabelImage& image, const SizeOptions& sizes, double delta_mm) {
  const double half_mm = *std::min_element(image.spacing.begin(), image.spacing.end()) / 2;
  if (sizes.delta_least_mm == 0) return std::min(half_mm, delta_mm);
  if (sizes.delta_least_mm > delta_mm)
    throw InputError(fmt::format("{} {:g} mm is above delta, {:g} mm", spelled("delta-least"),
                                 sizes.delta_least_mm, delta_mm));
  return sizes.delta_least_mm;
}

ThinLayers find_thin_layers(const LabelImage& image, const SizeOptions& sizes, double delta_mm, int threads) {
  ThinLayers found{DeltasAtVoxels(image, least_delta_mm(image, sizes, delta_mm), delta_mm), 0, {}};
  Layers(image, found.deltas, threads)(found.num_voxels, found.thinnest);
  if (!found.thinnest) return found;
  const auto& [label, at, thickness_mm] = *found.thinnest;
  const double needed_mm = kDeltaOverThickness * thickness_mm;
  if (sizes.delta_least_mm > needed_mm * (1 + kRounding))
    throw InputError(
        fmt::format("{} {:g} mm is above {:.4g} mm, which the thinnest layer needs: {} is {:.4g} mm thick at "
                    "voxel ({}, {}, {})",
                    spelled("delta-least"), sizes.delta_least_mm, needed_mm,
                    label == kBackground ? "the background" : name_of(image.labels[label]), thickness_mm,
                    at.i, at.j, at.k));
  return found;
}

}  // namespace podm
