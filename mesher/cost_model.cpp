#include "cost_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "runtime/parallel_for.h"

namespace podm {

namespace {

// Fitted to a few runs, right to about 30 %: cells = kVolumeCells V / r^3 + kSurfaceCells A / delta^2, with A
// counted in voxel faces.
constexpr double kVolumeCells = 4.5;
constexpr double kSurfaceCells = 4.0;
constexpr double kMaxDeltaVoxels = 2;
constexpr double kBytesPerCell = 110;
constexpr double kBytesPerVoxel = 6;

struct Geometry {
  double volume_mm3 = 0, area_mm2 = 0;
  std::vector<double> volume_of_label_mm3;
};

std::uint64_t count_differing(const LabelIndex* a, const LabelIndex* b, int size) {
  std::uint32_t count = 0;
  for (int i = 0; i < size; ++i) count += a[i] != b[i];
  return count;
}

// What the rows of voxels along x that one thread has seen add up to.
class alignas(64) RowCounts {
 public:
  explicit RowCounts(const LabelImage& image)
      : image_(image), outside_(static_cast<std::size_t>(image.size[0])), voxels_(image.labels.size()) {}

  void add_row(int j, int k) {
    const LabelIndex* const row = &image_.voxels[image_.index(0, j, k)];
    const std::size_t to_next_y = outside_.size(),
                      to_next_z = to_next_y * static_cast<std::size_t>(image_.size[1]);
    add_runs(row);
    add_faces(1, row, j, to_next_y);
    add_faces(2, row, k, to_next_z);
  }

  void operator+=(const RowCounts& b) {
    for (std::size_t label = 0; label < voxels_.size(); ++label) voxels_[label] += b.voxels_[label];
    for (std::size_t axis = 0; axis < 3; ++axis) faces_[axis] += b.faces_[axis];
  }

  Geometry geometry() const {
    const auto [sx, sy, sz] = image_.spacing;
    const std::array<double, 3> face_mm2{sy * sz, sx * sz, sx * sy};
    Geometry g;
    for (std::size_t axis = 0; axis < 3; ++axis)
      g.area_mm2 += static_cast<double>(faces_[axis]) * face_mm2[axis];
    for (const std::uint64_t voxels : voxels_)
      g.volume_of_label_mm3.push_back(static_cast<double>(voxels) * sx * sy * sz);
    g.volume_of_label_mm3[kBackground] = 0;
    for (const double v : g.volume_of_label_mm3) g.volume_mm3 += v;
    return g;
  }

 private:
  // A face lies between two runs of one label; outside is background.
  void add_runs(const LabelIndex* row) {
    const int size = image_.size[0];
    LabelIndex last = kBackground;
    for (int i = 0, end = 0; i < size; i = end) {
      while (end < size && row[end] == row[i]) ++end;
      voxels_[row[i]] += static_cast<std::uint64_t>(end - i);
      faces_[0] += row[i] != last;
      last = row[i];
    }
    faces_[0] += last != kBackground;
  }

  // To the row after, and to the one before where that is outside.
  void add_faces(std::size_t axis, const LabelIndex* row, int position, std::size_t to_next) {
    const int size = image_.size[0];
    const bool is_last = position + 1 == image_.size[axis];
    faces_[axis] += count_differing(row, is_last ? outside_.data() : row + to_next, size);
    if (position == 0) faces_[axis] += count_differing(row, outside_.data(), size);
  }

  const LabelImage& image_;
  std::vector<LabelIndex> outside_;       // a row of background
  std::vector<std::uint64_t> voxels_;     // by label
  std::array<std::uint64_t, 3> faces_{};  // between labels, by the axis they are normal to
};

Geometry measure(const LabelImage& image, int threads) {
  std::vector<RowCounts> counts(num_threads(threads), RowCounts(image));
  parallel_for(static_cast<std::size_t>(image.size[2]), counts.size(),
               [&](std::size_t k, std::size_t thread) {
                 for (int j = 0; j < image.size[1]; ++j) counts[thread].add_row(j, static_cast<int>(k));
               });
  for (std::size_t t = 1; t < counts.size(); ++t) counts[0] += counts[t];
  return counts[0].geometry();
}

// Of the foreground that one thread has seen.
struct alignas(64) VoxelBounds {
  std::array<int, 3> low, high{-1, -1, -1};

  void add(const std::array<int, 3>& a, const std::array<int, 3>& b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], a[axis]);
      high[axis] = std::max(high[axis], b[axis]);
    }
  }

  void add_row(const LabelImage& image, int j, int k) {
    const auto row = image.voxels.begin() + static_cast<std::ptrdiff_t>(image.index(0, j, k));
    const auto end = row + image.size[0];
    const auto is_foreground = [](LabelIndex label) { return label != kBackground; };
    const auto first = std::find_if(row, end, is_foreground);
    if (first == end) return;
    const auto after_last =
        std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), is_foreground).base();
    add({static_cast<int>(first - row), j, k}, {static_cast<int>(after_last - row) - 1, j, k});
  }
};

double cells_at(const LabelImage& image, const Geometry& g, const MeshingOptions& options) {
  double cells = 0, smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    const auto own = options.radius_of_mm.find(image.labels[i].value);
    const double radius = own != options.radius_of_mm.end() ? own->second : options.radius_mm;
    if (radius <= 0) continue;
    cells += kVolumeCells * g.volume_of_label_mm3[i] / (radius * radius * radius);
    smallest = std::min(smallest, radius);
  }
  const double delta =
      options.delta_mm > 0 ? options.delta_mm : default_delta_mm(image, std::isinf(smallest) ? 0 : smallest);
  return cells + kSurfaceCells * g.area_mm2 / (delta * delta);
}

}  // namespace

double default_delta_mm(const LabelImage& image, double radius_mm) {
  const double voxel = std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2]);
  return radius_mm > 0 ? std::min(kMaxDeltaVoxels * voxel, radius_mm / 2) : voxel;
}

Estimate estimate(const LabelImage& image, const MeshingOptions& options) {
  const double cells = options.target_elements > 0
                           ? static_cast<double>(options.target_elements)
                           : cells_at(image, measure(image, options.loop_threads()), options);
  return {cells, cells * kBytesPerCell + static_cast<double>(image.num_voxels()) * kBytesPerVoxel};
}

double radius_for_cells(const LabelImage& image, double cells, int threads) {
  const Geometry g = measure(image, threads);
  double low = 1e-9, high = 1e9;  // mm; the number of cells falls with the radius
  while (high / low > 1.001) {
    const double radius = std::sqrt(low * high), delta = radius / 2;
    const double expected = kVolumeCells * g.volume_mm3 / (radius * radius * radius) +
                            kSurfaceCells * g.area_mm2 / (delta * delta);
    (expected > cells ? low : high) = radius;
  }
  return high;
}

Box foreground_bounds(const LabelImage& image, int threads) {
  std::vector<VoxelBounds> bounds(num_threads(threads), VoxelBounds{image.size});
  parallel_for(static_cast<std::size_t>(image.size[2]), bounds.size(),
               [&](std::size_t k, std::size_t thread) {
                 for (int j = 0; j < image.size[1]; ++j)
                   bounds[thread].add_row(image, j, static_cast<int>(k));
               });
  for (const VoxelBounds& b : bounds) bounds[0].add(b.low, b.high);
  const auto& [low, high] = bounds[0];
  if (high[0] < 0) throw InputError("the image has no foreground");
  const auto& s = image.spacing;
  return {{(low[0] - 1) * s[0], (low[1] - 1) * s[1], (low[2] - 1) * s[2]},
          {(high[0] + 1) * s[0], (high[1] + 1) * s[1], (high[2] + 1) * s[2]}};
}

}  // namespace podm
