#include "claims/check_labels_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "parallel.h"
#include "ranks/part.h"

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

// Voxels of one label that follow one another in the grid.
struct Run {
  std::uint64_t first, count;
  LabelValue label;
};

// Finds the rank's own cells of voxel centers.
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
    const Box slab = slab_of(first_slice, end_slice);
    count(draw(slab), slab, overlaps);
  }

  // Collective. Adds the voxels in cells of all ranks. Each rank counts some slices of the grid, for which it
  // gets what the ranks have drawn; where two have, the later one holds the later cell.
  void count_on_ranks(int threads, std::unordered_map<LabelValue, LabelOverlap>& overlaps) const {
    Communication& ranks = ranks_of(mesh_);
    const Box slab = counted_slices();
    const std::uint64_t first = first_of_row(slab.first[2], 0);
    Labels labels(slab.length(0) * slab.length(1) * slab.length(2), kInNoCell);
    for (const Run& run : exchange_joined(ranks, draw_runs(threads)))
      std::fill_n(labels.begin() + static_cast<std::ptrdiff_t>(run.first - first), run.count, run.label);
    count(labels, slab, overlaps);
  }

 private:
  using Labels = std::vector<LabelValue>;  // of the voxels of a slab
  static constexpr LabelValue kInNoCell = std::numeric_limits<LabelValue>::min();

  std::uint64_t first_of_row(int k, int j) const {
    return (static_cast<std::uint64_t>(k) * static_cast<std::uint64_t>(image_.size[1]) +
            static_cast<std::uint64_t>(j)) *
           static_cast<std::uint64_t>(image_.size[0]);
  }

  Box slab_of(std::size_t first_slice, std::size_t end_slice) const {
    Box slab = box_;
    slab.last[2] = box_.first[2] + static_cast<int>(end_slice) - 1;
    slab.first[2] = box_.first[2] + static_cast<int>(first_slice);
    return slab;
  }

  // Returns the slices of the grid that this rank counts.
  Box counted_slices() const {
    const auto num_ranks = static_cast<std::size_t>(ranks_of(mesh_).size()),
               num_slices_of_grid = static_cast<std::size_t>(image_.size[2]);
    const auto first_of = [&](std::size_t rank) {
      return static_cast<int>((rank * num_slices_of_grid + num_ranks - 1) / num_ranks);
    };
    const auto rank = static_cast<std::size_t>(ranks_of(mesh_).rank());
    return {{0, 0, first_of(rank)}, {image_.size[0] - 1, image_.size[1] - 1, first_of(rank + 1) - 1}};
  }

  // Returns the runs of the rank's own cells for the ranks that count them.
  std::vector<std::vector<Run>> draw_runs(int threads) const {
    std::vector<std::vector<std::vector<Run>>> parts(static_cast<std::size_t>(threads),
                                                     lists_for<Run>(ranks_of(mesh_)));
    parallel_ranges(num_slices(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
      const Box slab = slab_of(begin, end);
      add_runs(draw(slab), slab, parts[thread]);
    });
    for (std::size_t t = 1; t < parts.size(); ++t)
      for (std::size_t r = 0; r < parts[t].size(); ++r)
        parts[0][r].insert(parts[0][r].end(), parts[t][r].begin(), parts[t][r].end());
    return std::move(parts[0]);
  }

  void add_runs(const Labels& labels, const Box& slab, std::vector<std::vector<Run>>& lists) const {
    const std::size_t length = slab.length(0);
    const LabelValue* row = labels.data();
    for (int k = slab.first[2]; k <= slab.last[2]; ++k) {
      std::vector<Run>& runs =
          lists[static_cast<std::size_t>(k) * lists.size() / static_cast<std::size_t>(image_.size[2])];
      for (int j = slab.first[1]; j <= slab.last[1]; ++j, row += length) {
        const std::uint64_t first = first_of_row(k, j) + static_cast<std::uint64_t>(slab.first[0]);
        for (std::size_t i = 0, end = 0; i < length; i = end) {
          for (end = i + 1; end < length && row[end] == row[i];) ++end;
          if (row[i] != kInNoCell) runs.push_back({first + i, end - i, row[i]});
        }
      }
    }
  }

  // Draws the rank's own cells that reach into the slab, in their order.
  Labels draw(const Box& slab) const {
    Labels labels(slab.length(0) * slab.length(1) * slab.length(2), kInNoCell);
    const IdRange own = own_cells(mesh_);
    for (auto cell = static_cast<CellId>(own.begin); cell < own.end; ++cell) {
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
        const std::uint32_t* voxel = image_.voxels.data() + first_of_row(k, j) + slab.first[0];
        for (std::size_t i = 0; i < slab.length(0); ++i) {
          if (row[i] == 0 || row[i] == kInNoCell) continue;
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
  const IdRange own = own_cells(mesh);
  parallel_ranges(own.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t c = own.begin + begin; c < own.begin + end; ++c)
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
  if (ranks_of(mesh).size() > 1) {
    raster.count_on_ranks(threads, drawn[0]);
  } else {
    parallel_ranges(raster.num_slices(), threads,
                    [&](std::size_t begin, std::size_t end, std::size_t thread) {
                      raster.count(begin, end, drawn[thread]);
                    });
  }

  const double frame_to_world =
      voxel_volume_mm3 / (image.spacing[0] * image.spacing[1] * image.spacing[2]);  // 1 without shear
  std::map<LabelValue, LabelOverlap> of_rank, overlaps;
  for (std::size_t t = 0; t < num_threads; ++t) {
    for (const auto& [label, volume] : volumes[t])
      of_rank[label].mesh_mm3 += static_cast<double>(volume / 6) * frame_to_world;
    for (const auto& [label, part] : drawn[t]) {
      of_rank[label].mesh_voxels += part.mesh_voxels;
      of_rank[label].both += part.both;
    }
  }
  for (const auto& part : gather(ranks_of(mesh), of_rank)) {
    for (const auto& [label, overlap] : part) {
      overlaps[label].mesh_mm3 += overlap.mesh_mm3;
      overlaps[label].mesh_voxels += overlap.mesh_voxels;
      overlaps[label].both += overlap.both;
    }
  }
  for (const auto& of_thread : voxels)
    for (const auto& [label, count] : of_thread) overlaps[label].image_voxels += count;
  overlaps.erase(0);
  return overlaps;
}

}  // namespace podm::verify
