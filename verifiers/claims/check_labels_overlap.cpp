#include "claims/check_labels_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "parallel.h"

namespace podm::verify {

namespace {

// A box of the grid; empty if first > last on some axis.
struct Box {
  std::array<int, 3> first{}, last{};

  std::size_t length(std::size_t axis) const {
    return static_cast<std::size_t>(std::max(0, last[axis] - first[axis] + 1));
  }
};

int clamped(double x, int low, int high) {
  return static_cast<int>(std::clamp(x, static_cast<double>(low), static_cast<double>(high)));
}

// A voxel center this near to a cell, in voxels, counts as inside: rounding must not lose centers on facets.
constexpr double kRounding = 1e-9;

// Returns the voxels of `within` whose indices lie in [low, high].
Box voxels_between(const Point& low, const Point& high, const Box& within) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.first[axis] = clamped(std::ceil(low[axis] - kRounding), within.first[axis], within.last[axis] + 1);
    box.last[axis] = clamped(std::floor(high[axis] + kRounding), within.first[axis] - 1, within.last[axis]);
  }
  return box;
}

// Finds the part of a line along x that lies in a tetrahedron: on the inner side of all four planes.
class Tetrahedron {
 public:
  explicit Tetrahedron(const std::array<Point, 4>& v) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Point &a = v[(i + 1) % 4], &b = v[(i + 2) % 4], &c = v[(i + 3) % 4], &apex = v[i];
      const Point d{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, e{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      Point n{d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]};
      double offset = n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
      if (n[0] * apex[0] + n[1] * apex[1] + n[2] * apex[2] < offset) {
        for (double& x : n) x = -x;
        offset = -offset;
      }
      const double norm = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      planes_[i] = {n[0], n[1], n[2], offset - kRounding * norm};
    }
  }

  std::array<double, 2> interval(double y, double z) const {
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& p : planes_) {
      const double rest = p[3] - p[1] * y - p[2] * z;  // p0 x >= rest
      if (p[0] > 0)
        low = std::max(low, rest / p[0]);
      else if (p[0] < 0)
        high = std::min(high, rest / p[0]);
      else if (rest > 0)
        return {1, 0};
    }
    return {low, high};
  }

 private:
  std::array<std::array<double, 4>, 4> planes_;
};

// Finds the cells of voxel centers.
class Raster {
 public:
  Raster(const Mesh& mesh, const Image& image, const std::vector<Point>& points)
      : mesh_(mesh), image_(image), points_(points) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Point low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
    for (const Point& p : points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis] / image.spacing[axis]);
        high[axis] = std::max(high[axis], p[axis] / image.spacing[axis]);
      }
    Box grid;
    for (std::size_t axis = 0; axis < 3; ++axis) grid.last[axis] = image.size[axis] - 1;
    box_ = voxels_between(low, high, grid);
  }

  std::size_t num_slices() const { return box_.length(2); }

  // Adds the voxels of these slices to `overlaps`.
  void count(std::size_t first_slice, std::size_t end_slice,
             std::unordered_map<LabelValue, LabelOverlap>& overlaps) const {
    Box slab = box_;
    slab.last[2] = box_.first[2] + static_cast<int>(end_slice) - 1;
    slab.first[2] = box_.first[2] + static_cast<int>(first_slice);
    count(draw(slab), slab, overlaps);
  }

 private:
  using Labels = std::vector<LabelValue>;  // of the voxels of a slab; 0: in no cell

  // Draws all cells that reach into the slab, in their order.
  Labels draw(const Box& slab) const {
    Labels labels(slab.length(0) * slab.length(1) * slab.length(2));
    for (CellId cell = 0; cell < mesh_.cells.size(); ++cell) {
      std::array<Point, 4> v;
      for (std::size_t i = 0; i < 4; ++i) {
        v[i] = points_[mesh_.cells[cell][i]];
        for (std::size_t axis = 0; axis < 3; ++axis) v[i][axis] /= image_.spacing[axis];
      }
      Point low = v[0], high = v[0];
      for (const Point& p : v)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], p[axis]);
          high[axis] = std::max(high[axis], p[axis]);
        }
      const Box box = voxels_between(low, high, slab);
      if (box.length(0) * box.length(1) * box.length(2) > 0)
        draw(Tetrahedron(v), box, mesh_.cell_labels[cell], slab, labels);
    }
    return labels;
  }

  static void draw(const Tetrahedron& tetrahedron, const Box& box, LabelValue label, const Box& slab,
                   Labels& labels) {
    for (int k = box.first[2]; k <= box.last[2]; ++k)
      for (int j = box.first[1]; j <= box.last[1]; ++j) {
        const auto [low, high] = tetrahedron.interval(j, k);
        if (!(low <= high)) continue;
        const int first = clamped(std::ceil(low), box.first[0], box.last[0] + 1),
                  last = clamped(std::floor(high), box.first[0] - 1, box.last[0]);
        LabelValue* row = labels.data() + (static_cast<std::size_t>(k - slab.first[2]) * slab.length(1) +
                                           static_cast<std::size_t>(j - slab.first[1])) *
                                              slab.length(0);
        for (int i = first; i <= last; ++i) row[i - slab.first[0]] = label;
      }
  }

  void count(const Labels& labels, const Box& slab,
             std::unordered_map<LabelValue, LabelOverlap>& overlaps) const {
    const LabelValue* row = labels.data();
    for (int k = slab.first[2]; k <= slab.last[2]; ++k)
      for (int j = slab.first[1]; j <= slab.last[1]; ++j, row += slab.length(0)) {
        const std::uint32_t* voxel = image_.voxels.data() +
                                     (static_cast<std::size_t>(k) * static_cast<std::size_t>(image_.size[1]) +
                                      static_cast<std::size_t>(j)) *
                                         static_cast<std::size_t>(image_.size[0]) +
                                     slab.first[0];
        for (std::size_t i = 0; i < slab.length(0); ++i) {
          if (row[i] == 0) continue;
          LabelOverlap& overlap = overlaps[row[i]];
          ++overlap.mesh_voxels;
          overlap.both += row[i] == static_cast<LabelValue>(voxel[i]) ? 1 : 0;
        }
      }
  }

  const Mesh& mesh_;
  const Image& image_;
  const std::vector<Point>& points_;
  Box box_;
};

long double six_volumes(const std::array<VertexId, 4>& v, const std::vector<Point>& p) {
  std::array<std::array<long double, 3>, 3> e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      e[i][axis] = static_cast<long double>(p[v[i + 1]][axis]) - p[v[0]][axis];
  return std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                  e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                  e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]));
}

template <class Value>
using PerThread = std::vector<std::unordered_map<LabelValue, Value>>;

}  // namespace

std::map<LabelValue, LabelOverlap> find_overlaps(const Mesh& mesh, const Image& image,
                                                 const std::vector<Point>& points, double voxel_volume_mm3,
                                                 int threads) {
  const auto num_threads = static_cast<std::size_t>(threads);
  PerThread<long double> volumes(num_threads);
  parallel_ranges(mesh.cells.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t c = begin; c < end; ++c)
      volumes[thread][mesh.cell_labels[c]] += six_volumes(mesh.cells[c], points);
  });
  PerThread<std::uint64_t> voxels(num_threads);
  parallel_ranges(image.voxels.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t i = begin, run = begin; i < end; i = run) {
      while (run < end && image.voxels[run] == image.voxels[i]) ++run;
      voxels[thread][image.voxels[i]] += run - i;
    }
  });
  const Raster raster(mesh, image, points);
  PerThread<LabelOverlap> drawn(num_threads);
  parallel_ranges(raster.num_slices(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    raster.count(begin, end, drawn[thread]);
  });

  const double frame_to_world =
      voxel_volume_mm3 / (image.spacing[0] * image.spacing[1] * image.spacing[2]);  // 1 without shear
  std::map<LabelValue, LabelOverlap> overlaps;
  for (std::size_t t = 0; t < num_threads; ++t) {
    for (const auto& [label, volume] : volumes[t])
      overlaps[label].mesh_mm3 += static_cast<double>(volume / 6) * frame_to_world;
    for (const auto& [label, count] : voxels[t]) overlaps[label].image_voxels += count;
    for (const auto& [label, part] : drawn[t]) {
      overlaps[label].mesh_voxels += part.mesh_voxels;
      overlaps[label].both += part.both;
    }
  }
  overlaps.erase(0);
  return overlaps;
}

}  // namespace podm::verify
