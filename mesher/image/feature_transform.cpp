#include "image/feature_transform.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "podm/errors.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

using VoxelIndex = FeatureTransform::VoxelIndex;
constexpr VoxelIndex kNone = FeatureTransform::kNone;

// Lines along y and z are worked on in tiles of neighbours in x: whole cache lines travel.
constexpr int kTileWidth = 32;

constexpr double square(double x) { return x * x; }

// The parabolas cost + (spacing * (i - position))^2 of one line that are lowest somewhere.
class LowerEnvelope {
 public:
  LowerEnvelope(int length, double spacing)
      : sites_(static_cast<std::size_t>(length)), squared_spacing_(square(spacing)) {}

  void clear() { count_ = 0; }

  /// Adds the site at `position`, beyond all earlier ones.
  void add(int position, double cost, VoxelIndex feature) {
    const Site site{static_cast<double>(position), cost, feature};
    while (count_ >= 2 && is_hidden(sites_[count_ - 2], sites_[count_ - 1], site)) --count_;
    sites_[count_++] = site;
  }

  /// Calls write(i, site) for i in [0, length) with the lowest site there, the first of equals.
  template <class Write>
  void for_each_lowest(int length, Write&& write) const {
    for (std::size_t i = 0, s = 0; i < static_cast<std::size_t>(length); ++i) {
      while (s + 1 < count_ && height(sites_[s + 1], i) < height(sites_[s], i)) ++s;
      write(static_cast<int>(i), sites_[s]);
    }
  }

  bool is_empty() const { return count_ == 0; }

  struct Site {
    double position, cost;
    VoxelIndex feature;
  };

 private:
  double height(const Site& s, std::size_t i) const {
    return s.cost + squared_spacing_ * square(static_cast<double>(i) - s.position);
  }

  // Whether b, between a and c, is nowhere lower than both.
  bool is_hidden(const Site& a, const Site& b, const Site& c) const {
    const double ab = b.position - a.position, bc = c.position - b.position, ac = ab + bc;
    return ac * b.cost - bc * a.cost - ab * c.cost > ab * bc * ac * squared_spacing_;
  }

  std::vector<Site> sites_;
  std::size_t count_ = 0;
  double squared_spacing_;
};

// Buffers of one thread.
struct Workspace {
  Workspace(const LabelImage& image)
      : is_surface(static_cast<std::size_t>(image.size[0])),
        tile(static_cast<std::size_t>(kTileWidth) *
             static_cast<std::size_t>(std::max(image.size[1], image.size[2]))),
        along_y(image.size[1], image.spacing[1]),
        along_z(image.size[2], image.spacing[2]) {}

  std::vector<std::uint8_t> is_surface;
  std::vector<VoxelIndex> tile;
  LowerEnvelope along_y, along_z;
};

class Transformer {
 public:
  Transformer(const LabelImage& image, HugeArray<VoxelIndex>& features)
      : voxels_(image.voxels.data()),
        features_(features),
        num_x_(image.size[0]),
        num_y_(image.size[1]),
        num_z_(image.size[2]),
        row_(static_cast<std::size_t>(image.size[0])),
        slice_(row_ * static_cast<std::size_t>(image.size[1])),
        spacing_(image.spacing),
        inverse_row_(1.0 / image.size[0]) {}

  // Features become x of the nearest surface voxel in the x-line, then y * num_x + x of that in the slice.
  void transform_slice(int z, Workspace& work) {
    for (int y = 0; y < num_y_; ++y) {
      mark_surface(y, z, work.is_surface.data());
      find_nearest_in_row(work.is_surface.data(), &features_[row_start(y, z)]);
    }
    const std::size_t start = row_start(0, z);
    for (int x = 0; x < num_x_; x += kTileWidth) {
      transform_tile(
          start + static_cast<std::size_t>(x), row_, num_y_, work,
          [&](int c, int y, VoxelIndex f) {
            work.along_y.add(y, square(spacing_[0] * (x + c - static_cast<double>(f))),
                             static_cast<VoxelIndex>(y) * static_cast<VoxelIndex>(num_x_) + f);
          },
          work.along_y);
    }
  }

  // Features of the lines along z at this y become voxel indices.
  void transform_depth(int y, Workspace& work) {
    for (int x = 0; x < num_x_; x += kTileWidth) {
      transform_tile(
          row_start(y, 0) + static_cast<std::size_t>(x), slice_, num_z_, work,
          [&](int c, int z, VoxelIndex f) {
            // Exact: (f + 0.5) / num_x is at least 0.5 / num_x from an integer, far more than it is rounded
            // by.
            const double fy = static_cast<double>(static_cast<VoxelIndex>((f + 0.5) * inverse_row_));
            const double fx = f - fy * num_x_;
            work.along_z.add(z, square(spacing_[0] * (x + c - fx)) + square(spacing_[1] * (y - fy)),
                             static_cast<VoxelIndex>(static_cast<std::size_t>(z) * slice_) + f);
          },
          work.along_z);
    }
  }

 private:
  std::size_t row_start(int y, int z) const {
    return static_cast<std::size_t>(z) * slice_ + static_cast<std::size_t>(y) * row_;
  }

  void mark_surface(int y, int z, std::uint8_t* is_surface) const {
    const std::size_t start = row_start(y, z);
    const LabelIndex* row = voxels_ + start;
    for (int x = 0; x < num_x_; ++x) is_surface[x] = 0;
    mark_differing(row, y > 0 ? row - row_ : nullptr, is_surface);
    mark_differing(row, y + 1 < num_y_ ? row + row_ : nullptr, is_surface);
    mark_differing(row, z > 0 ? row - slice_ : nullptr, is_surface);
    mark_differing(row, z + 1 < num_z_ ? row + slice_ : nullptr, is_surface);
    for (int x = 0; x + 1 < num_x_; ++x) {
      const std::uint8_t differ = row[x] != row[x + 1];
      is_surface[x] |= differ;
      is_surface[x + 1] |= differ;
    }
    is_surface[0] |= row[0] != kBackground;
    is_surface[num_x_ - 1] |= row[num_x_ - 1] != kBackground;
  }

  // `other` null: outside the grid.
  void mark_differing(const LabelIndex* row, const LabelIndex* other, std::uint8_t* is_surface) const {
    if (other == nullptr) {
      for (int x = 0; x < num_x_; ++x) is_surface[x] |= row[x] != kBackground;
    } else {
      for (int x = 0; x < num_x_; ++x) is_surface[x] |= row[x] != other[x];
    }
  }

  void find_nearest_in_row(const std::uint8_t* is_surface, VoxelIndex* nearest) const {
    int begin = 0;  // of the voxels whose nearest is still unknown
    VoxelIndex last = kNone;
    for (int x = 0; x < num_x_; ++x) {
      if (!is_surface[x]) continue;
      const VoxelIndex here = static_cast<VoxelIndex>(x);
      const int middle = last == kNone ? 0 : static_cast<int>((last + here) / 2) + 1;
      std::fill(nearest + begin, nearest + std::max(begin, middle), last);
      std::fill(nearest + std::max(begin, middle), nearest + x + 1, here);
      begin = x + 1;
      last = here;
    }
    std::fill(nearest + begin, nearest + num_x_, last);
  }

  // Replaces the features of up to kTileWidth lines of `length` voxels, `stride` apart, by the lowest sites
  // of their envelopes. `add(c, i, feature)` adds voxel i of line c to the envelope.
  template <class Add>
  void transform_tile(std::size_t start, std::size_t stride, int length, Workspace& work, Add&& add,
                      LowerEnvelope& envelope) {
    const int width = std::min(kTileWidth, num_x_ - static_cast<int>(start % row_));
    VoxelIndex* const tile = work.tile.data();
    for (int i = 0; i < length; ++i) {
      const VoxelIndex* from = &features_[start + static_cast<std::size_t>(i) * stride];
      for (int c = 0; c < width; ++c) tile[c * length + i] = from[c];
    }
    for (int c = 0; c < width; ++c) {
      VoxelIndex* const line = tile + c * length;
      envelope.clear();
      for (int i = 0; i < length; ++i) {
        if (line[i] != kNone) add(c, i, line[i]);
      }
      if (envelope.is_empty()) continue;
      envelope.for_each_lowest(length,
                               [&](int i, const LowerEnvelope::Site& site) { line[i] = site.feature; });
    }
    for (int i = 0; i < length; ++i) {
      VoxelIndex* to = &features_[start + static_cast<std::size_t>(i) * stride];
      for (int c = 0; c < width; ++c) to[c] = tile[c * length + i];
    }
  }

  const LabelIndex* voxels_;
  HugeArray<VoxelIndex>& features_;
  int num_x_, num_y_, num_z_;
  std::size_t row_, slice_;  // voxels
  std::array<double, 3> spacing_;
  double inverse_row_;
};

// The words of surface voxels, see Neighborhood.
class NeighborhoodFinder {
 public:
  explicit NeighborhoodFinder(const LabelImage& image) : image_(image) {}

  std::uint32_t bits(std::size_t voxel) const {
    const auto row = static_cast<std::size_t>(image_.size[0]),
               rows = static_cast<std::size_t>(image_.size[1]);
    const int x = static_cast<int>(voxel % row), y = static_cast<int>(voxel / row % rows),
              z = static_cast<int>(voxel / row / rows);
    const LabelIndex own = image_.voxels[voxel];
    std::uint32_t bits = 0;
    std::optional<LabelIndex> other;
    bool has_two_labels = true;
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const LabelIndex label = label_at(x + i, y + j, z + k);
          if (label == own) continue;
          bits |= 1u << Neighborhood::position(i, j, k);
          has_two_labels = has_two_labels && other.value_or(label) == label;
          other = label;
        }
      }
    }
    return bits | static_cast<std::uint32_t>(has_two_labels) << 30;
  }

 private:
  LabelIndex label_at(int x, int y, int z) const {
    const auto is_in = [](int i, int n) { return static_cast<unsigned>(i) < static_cast<unsigned>(n); };
    return is_in(x, image_.size[0]) && is_in(y, image_.size[1]) && is_in(z, image_.size[2])
               ? image_.voxels[image_.index(x, y, z)]
               : kBackground;
  }

  const LabelImage& image_;
};

std::size_t checked_num_voxels(const LabelImage& image) {
  static_assert(kMaxVoxels == kNone, "kNone is no voxel");
  if (image.num_voxels() > kMaxVoxels) {
    throw InputError("image: " + std::to_string(image.num_voxels()) +
                     " voxels; the feature transform takes at most " + std::to_string(kMaxVoxels));
  }
  return image.num_voxels();
}

}  // namespace

FeatureTransform::FeatureTransform(const LabelImage& image, int threads)
    : HugeArray<std::uint32_t>(checked_num_voxels(image)), Features<NoReads>(&(*this)[0], {}) {
  HugeArray<std::uint32_t>& words = *this;
  const auto num_y = static_cast<std::size_t>(image.size[1]), num_z = static_cast<std::size_t>(image.size[2]);
  const std::size_t used = std::clamp<std::size_t>(num_threads(threads), 1, std::max(num_y, num_z));
  std::vector<Workspace> workspaces(used, Workspace(image));
  Transformer transformer(image, words);
  parallel_for(num_z, used, [&](std::size_t z, std::size_t thread) {
    transformer.transform_slice(static_cast<int>(z), workspaces[thread]);
  });
  parallel_for(num_y, used, [&](std::size_t y, std::size_t thread) {
    transformer.transform_depth(static_cast<int>(y), workspaces[thread]);
  });
  const NeighborhoodFinder finder(image);
  const std::size_t slice = image.num_voxels() / num_z;
  parallel_for(num_z, used, [&](std::size_t z, std::size_t) {
    for (std::size_t v = z * slice; v < (z + 1) * slice; ++v) {
      if (words[v] == v) words[v] = kSurface | finder.bits(v);
    }
  });
}

}  // namespace podm
