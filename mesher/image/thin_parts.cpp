#include "image/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "image/components.h"
#include "image/label_depths.h"

namespace podm {

namespace {

constexpr double kDepthOverDelta = 0.7;
// Slack added to the radius of a ball, relative to the shortest side of a voxel. Balls with this slack cover
// the steps of an oblique surface. With less than half a side, they contain no center of another label.
constexpr double kSlackOverSide = 0.4;
float squared(float x) { return x * x; }

constexpr float kInfinite = std::numeric_limits<float>::infinity();

class ThinParts {
 public:
  ThinParts(const LabelImage& image, double delta_mm, int threads)
      : image_(image),
        longest_mm_(*std::max_element(image.spacing.begin(), image.spacing.end())),
        slack_mm_(kSlackOverSide * *std::min_element(image.spacing.begin(), image.spacing.end())),
        least_mm_(kDepthOverDelta * std::max(delta_mm, longest_mm_)),
        depths_(image, static_cast<float>(most_mm() * most_mm()), threads) {
    find_label_depths(depths_, most_mm());
    split_image(threads);
  }

  std::vector<ThinPart> sorted() {
    const Components all(image_), thin(thin_), kept(kept_);
    std::vector<int> pieces(all.size());
    for (Components::Id c = 0; c < kept.size(); ++c)
      if (kept[c].label != kBackground) ++pieces[all.of(kept[c].first)];
    std::vector<ThinPart> parts(thin.size());
    std::vector<std::set<Components::Id>> beside(thin.size());
    thin.for_each_run([&](Components::Id part, const Voxel& first, int length) {
      if (thin[part].label == kBackground) return;
      for (Voxel v = first; v.i < first.i + length; ++v.i) {
        deepen(parts[part], v);
        if (pieces[all.of(v)] > 1) add_kept_beside(kept, v, beside[part]);
      }
    });
    std::vector<ThinPart> sorted;
    for (Components::Id part = 0; part < thin.size(); ++part) {
      if (thin[part].label == kBackground) continue;
      ThinPart& reported = parts[part];
      reported.label = thin[part].label;
      reported.num_voxels = thin[part].num_voxels;
      reported.kind = pieces[all.of(thin[part].first)] == 0 ? ThinKind::kWhole
                      : beside[part].size() > 1             ? ThinKind::kBridge
                                                            : ThinKind::kDetail;
      sorted.push_back(reported);
    }
    std::stable_sort(sorted.begin(), sorted.end(), [](const ThinPart& a, const ThinPart& b) {
      return std::pair(a.kind, b.num_voxels) < std::pair(b.kind, a.num_voxels);
    });
    return sorted;
  }

 private:
  // From voxel to voxel the depth grows by at most a side. Balls of greater depths therefore add nothing near
  // a surface.
  double most_mm() const { return least_mm_ + longest_mm_; }

  // Makes an image of the thin voxels and one of the kept voxels. All other voxels are background there.
  void split_image(int threads) {
    constexpr float kRounding = 1e-5F;
    VoxelField balls(image_, kInfinite, threads);
    const auto squared_least = static_cast<float>(least_mm_ * least_mm_ * (1 - kRounding));
    for (std::size_t i = 0; i < image_.voxels.size(); ++i)
      if (image_.voxels[i] != kBackground && depths_[i] >= squared_least)
        balls[i] = -squared(std::sqrt(depths_[i]) + static_cast<float>(slack_mm_));
    unite_balls(balls, most_mm() + slack_mm_);
    thin_.size = kept_.size = image_.size;
    thin_.voxels = kept_.voxels = image_.voxels;
    const float beyond = kRounding * squared_least;
    for (std::size_t i = 0; i < image_.voxels.size(); ++i)
      (balls[i] > beyond ? kept_ : thin_).voxels[i] = kBackground;
  }

  void deepen(ThinPart& part, const Voxel& v) {
    const double thickness_mm = 2 * std::sqrt(static_cast<double>(depths_[image_.index(v.i, v.j, v.k)]));
    if (thickness_mm <= part.thickness_mm) return;
    part.thickness_mm = thickness_mm;
    part.deepest = v;
  }

  void add_kept_beside(const Components& kept, const Voxel& v, std::set<Components::Id>& pieces) const {
    const LabelIndex label = image_.voxels[image_.index(v.i, v.j, v.k)];
    for (const Voxel& step : {Voxel{1, 0, 0}, Voxel{0, 1, 0}, Voxel{0, 0, 1}})
      for (const int sign : {-1, 1}) {
        const Voxel other{v.i + sign * step.i, v.j + sign * step.j, v.k + sign * step.k};
        const bool is_inside = other.i >= 0 && other.j >= 0 && other.k >= 0 && other.i < image_.size[0] &&
                               other.j < image_.size[1] && other.k < image_.size[2];
        if (is_inside && kept_.voxels[image_.index(other.i, other.j, other.k)] == label)
          pieces.insert(kept.of(other));
      }
  }

  const LabelImage& image_;
  double longest_mm_, slack_mm_, least_mm_;
  VoxelField depths_;
  LabelImage thin_, kept_;
};

}  // namespace

std::vector<ThinPart> find_thin_parts(const LabelImage& image, double delta_mm, int threads) {
  return ThinParts(image, delta_mm, threads).sorted();
}

}  // namespace podm
