#include "run/measure_quality.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "geometry/circumsphere.h"
#include "geometry/dihedral.h"
#include "geometry/predicates.h"
#include "geometry/tetrahedron.h"
#include "image/foreground.h"
#include "image/working_frame.h"
#include "run/extract_lines.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kLargeLabelVoxels = 1000;  // larger labels must appear in the mesh

Point point_of(const TetMesh& mesh, std::uint32_t v) {
  return {mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
}

double squared_cotangent(const Vector& u, const Vector& v) {
  return signed_square_ratio(dot(u, v), squared_length(cross(u, v)));
}

// The sum over all items, computed in slices by add(tally, begin, end). Any thread may process a slice. The
// slices are summed in their order. Rounding is therefore the same for any number of threads.
template <class Tally, class Add>
Tally tally_up(std::size_t num_items, std::size_t num_slices, int threads, const Tally& none,
               const Add& add) {
  const std::size_t length = (num_items + num_slices - 1) / num_slices;
  std::vector<Tally> slices(num_slices, none);
  parallel_for(num_slices, num_threads(threads), [&](std::size_t slice, std::size_t) {
    const std::size_t begin = std::min(num_items, slice * length);
    add(slices[slice], begin, std::min(num_items, begin + length));
  });
  for (std::size_t slice = 1; slice < num_slices; ++slice) slices[0] += slices[slice];
  return std::move(slices[0]);
}

constexpr std::size_t kMostSlices = 256;

using Corners = std::array<Point, 4>;

struct CellMeasures {
  double determinant, squared_length;  // of the RelativeSphere
  double squared_radius, shortest2;
  DihedralExtremes dihedral;
};

inline double least(double a, double b) { return a < b ? a : b; }

// Has neither branch nor loop. A loop over it can therefore be vectorised.
inline CellMeasures measure_cell(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Vector da = a - d, db = b - d, dc = c - d;
  const double aa = squared_length(da), bb = squared_length(db), cc = squared_length(dc);
  const RelativeSphere sphere = relative_sphere(da, db, dc, aa, bb, cc);
  return {sphere.determinant, sphere.squared_length, squared_distance(d + sphere.center, d),
          least(least(least(aa, bb), least(cc, squared_distance(a, b))),
                least(squared_distance(a, c), squared_distance(b, c))),
          dihedral_extremes(a, b, c, d)};
}

// True if the cell is neither flat nor inverted. In that case an inaccurate radius is computed again.
bool is_positive(const Corners& p, CellMeasures& m) {
  // The cell is then positive and its radius accurate, by the error bounds in circumsphere.h.
  if (m.determinant < 0 && is_well_conditioned(m.determinant, m.squared_length)) return true;
  if (orientation(p[0], p[1], p[2], p[3]) <= 0) return false;
  m.squared_radius = circumsphere(p[0], p[1], p[2], p[3], 0).squared_radius;
  return true;
}

// A block of cells, measured side by side.
class CellBlock {
 public:
  static constexpr std::size_t kSize = 16;

  void set(std::size_t i, const Corners& p) {
    for (unsigned v = 0; v < 4; ++v) x_[v][i] = p[v].x, y_[v][i] = p[v].y, z_[v][i] = p[v].z;
  }
  Corners corners(std::size_t i) const { return {point(0, i), point(1, i), point(2, i), point(3, i)}; }
  void measure() {
    for (std::size_t i = 0; i < kSize; ++i) {
      const CellMeasures m = measure_cell(point(0, i), point(1, i), point(2, i), point(3, i));
      determinant_[i] = m.determinant;
      squared_length_[i] = m.squared_length;
      squared_radius_[i] = m.squared_radius;
      shortest2_[i] = m.shortest2;
      of_least_[i] = m.dihedral.of_least;
      of_largest_[i] = m.dihedral.of_largest;
      six_volumes_[i] = m.dihedral.determinant;
    }
  }
  CellMeasures measures(std::size_t i) const {
    return {determinant_[i],
            squared_length_[i],
            squared_radius_[i],
            shortest2_[i],
            {of_least_[i], of_largest_[i], six_volumes_[i]}};
  }

 private:
  Point point(unsigned v, std::size_t i) const { return {x_[v][i], y_[v][i], z_[v][i]}; }

  using Doubles = std::array<double, kSize>;
  std::array<Doubles, 4> x_, y_, z_;
  Doubles determinant_, squared_length_, squared_radius_, shortest2_, of_least_, of_largest_, six_volumes_;
};

struct alignas(64) CellTally {
  struct OfLabel {
    double volume_mm3 = 0;
    std::uint64_t cells = 0;
  };

  double max_ratio2 = 0, max_radius2 = 0, shortest2 = kInfinity;
  double of_least = -kInfinity, of_largest = kInfinity;  // dihedral angles, as squared cotangents
  std::uint64_t bad_orientation = 0, bad_radius_edge = 0, bad_radius = 0;
  std::vector<OfLabel> labels;

  void add(const Corners& p, CellMeasures m, LabelIndex label, double squared_radius_bound) {
    if (!is_positive(p, m)) {
      ++bad_orientation;
      return;
    }
    const double ratio2 = m.squared_radius / m.shortest2;
    bad_radius_edge += ratio2 >= kRadiusEdgeBound * kRadiusEdgeBound;
    bad_radius += m.squared_radius > squared_radius_bound;
    max_ratio2 = std::max(max_ratio2, ratio2);
    max_radius2 = std::max(max_radius2, m.squared_radius);
    shortest2 = std::min(shortest2, m.shortest2);
    of_least = std::max(of_least, m.dihedral.of_least);
    of_largest = std::min(of_largest, m.dihedral.of_largest);
    labels[label].volume_mm3 += m.dihedral.determinant / 6;
    ++labels[label].cells;
  }

  void operator+=(const CellTally& b) {
    max_ratio2 = std::max(max_ratio2, b.max_ratio2);
    max_radius2 = std::max(max_radius2, b.max_radius2);
    shortest2 = std::min(shortest2, b.shortest2);
    of_least = std::max(of_least, b.of_least);
    of_largest = std::min(of_largest, b.of_largest);
    bad_orientation += b.bad_orientation;
    bad_radius_edge += b.bad_radius_edge;
    bad_radius += b.bad_radius;
    for (std::size_t label = 0; label < labels.size(); ++label) {
      labels[label].volume_mm3 += b.labels[label].volume_mm3;
      labels[label].cells += b.labels[label].cells;
    }
  }
};

constexpr std::size_t kLookahead = 32;  // prefetch distance for vertices, in cells

// Calls use(cell, corners, measures) for the cells of [begin, end).
template <class Use>
void for_each_measured(const TetMesh& mesh, std::size_t begin, std::size_t end, const Use& use) {
  CellBlock block{};
  for (std::size_t first = begin; first < end; first += CellBlock::kSize) {
    const std::size_t count = std::min(CellBlock::kSize, end - first);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& cell = mesh.cells[first + i];
      const auto& later = mesh.cells[std::min(first + i + kLookahead, end - 1)];
      for (const std::uint32_t v : later) __builtin_prefetch(&mesh.vertices[v]);
      block.set(i, {point_of(mesh, cell[0]), point_of(mesh, cell[1]), point_of(mesh, cell[2]),
                    point_of(mesh, cell[3])});
    }
    block.measure();
    for (std::size_t i = 0; i < count; ++i) use(first + i, block.corners(i), block.measures(i));
  }
}

// The size field in the space of the mesh.
class Bounds {
 public:
  Bounds(const SizeField& sizes, const LabelImage& image, Space space)
      : sizes_(sizes), to_working_(inverse(working_to_world(image))) {
    if (space == Space::kLps)
      for (const std::size_t row : {0, 1, 2})
        for (const std::size_t axis : {0, 1}) to_working_[4 * row + axis] *= -1;
  }
  // A cell no larger than the least bound meets every local bound. Its circumcenter is therefore not
  // computed.
  double squared_radius(const Corners& p, const CellMeasures& m, LabelIndex label) const {
    if (!sizes_.has_grid() || m.squared_radius <= sizes_.smallest_squared_radius())
      return sizes_.squared_radius_of_label(label);
    return sizes_.squared_radius(label, map(to_working_, circumsphere(p[0], p[1], p[2], p[3], 0).center));
  }

 private:
  const SizeField& sizes_;
  Affine to_working_;
};

void add_cells(const TetMesh& mesh, const Bounds& bounds, std::size_t begin, std::size_t end,
               CellTally& tally) {
  for_each_measured(mesh, begin, end, [&](std::size_t cell, const Corners& corners, const CellMeasures& m) {
    const LabelIndex label = mesh.cell_labels[cell];
    tally.add(corners, m, label, bounds.squared_radius(corners, m, label));
  });
}

CellTally measure_cells(const TetMesh& mesh, const Bounds& bounds, int threads, MeshingReport& report) {
  CellTally none;
  none.labels.resize(mesh.labels.size());
  // With this limit the sums of all labels take at most 4 bytes per cell.
  const std::size_t num_slices =
      std::clamp<std::size_t>(mesh.cells.size() / (4 * mesh.labels.size()), 1, kMostSlices);
  CellTally tally = tally_up(mesh.cells.size(), num_slices, threads, none,
                             [&](CellTally& slice, std::size_t begin, std::size_t end) {
                               add_cells(mesh, bounds, begin, end, slice);
                             });
  report.guarantees.orientation = tally.bad_orientation;
  report.guarantees.radius_edge = tally.bad_radius_edge;
  report.guarantees.radius = tally.bad_radius;
  report.quality.max_radius_edge = std::sqrt(tally.max_ratio2);
  report.quality.max_radius_mm = std::sqrt(tally.max_radius2);
  report.quality.shortest_edge_mm = tally.shortest2 < kInfinity ? std::sqrt(tally.shortest2) : 0;
  report.quality.min_dihedral_deg = angle_deg(tally.of_least);
  report.quality.max_dihedral_deg = angle_deg(tally.of_largest);
  return tally;
}

struct alignas(64) FacetTally {
  double least_cotangent2 = kInfinity, most_cotangent2 = -kInfinity;
  std::uint64_t bad = 0;

  void add(const Point& a, const Point& b, const Point& c, double bad_cotangent2 = kBadCotangent2) {
    const double at_a = squared_cotangent(b - a, c - a), at_b = squared_cotangent(c - b, a - b),
                 at_c = squared_cotangent(a - c, b - c);
    const double sharpest = std::max(at_a, std::max(at_b, at_c));
    bad += sharpest >= bad_cotangent2;
    most_cotangent2 = std::max(most_cotangent2, sharpest);
    least_cotangent2 = std::min(least_cotangent2, std::min(at_a, std::min(at_b, at_c)));
  }
  void operator+=(const FacetTally& b) {
    least_cotangent2 = std::min(least_cotangent2, b.least_cotangent2);
    most_cotangent2 = std::max(most_cotangent2, b.most_cotangent2);
    bad += b.bad;
  }
  /// None if there is no facet.
  std::optional<double> least_angle_deg() const {
    if (most_cotangent2 == -kInfinity) return std::nullopt;
    return angle_deg(most_cotangent2);
  }

  static_assert(kFacetAngleBound == 30);
  static constexpr double kBadCotangent2 = 3;
  static constexpr double kBadCotangent2NearLines = 2 * 4 - 1;  // R3's circumradius is sqrt(2) sides there
};

// Measures what is near lines, again, and what is not: most meshes have no lines. Facets and cells are near
// lines if they have an end of an edge along which three labels meet. Stray edges count: vertices of an arc
// may be joined by an edge along which other labels meet, and refinement applies the weaker bound there, too.
class NearLines {
 public:
  NearLines(const TetMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& strays)
      : mesh_(mesh), is_on_line_(mesh.vertices.size()) {
    for (const auto& edges : {std::cref(mesh.lines.edges), std::cref(strays)})
      for (const auto& [a, b] : edges.get()) is_on_line_[a] = is_on_line_[b] = true;
  }
  void measure(LinesReport& report, Guarantees& guarantees) const;

 private:
  template <std::size_t N>
  bool is_near(const std::array<std::uint32_t, N>& vertices) const {
    return std::any_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return is_on_line_[v]; });
  }

  const TetMesh& mesh_;
  std::vector<bool> is_on_line_;
};

void NearLines::measure(LinesReport& report, Guarantees& guarantees) const {
  FacetTally near, away;
  for (const auto& facet : mesh_.facets) {
    const bool is_near_line = is_near(facet);
    report.facets_near += is_near_line;
    (is_near_line ? near : away)
        .add(point_of(mesh_, facet[0]), point_of(mesh_, facet[1]), point_of(mesh_, facet[2]),
             is_near_line ? FacetTally::kBadCotangent2NearLines : FacetTally::kBadCotangent2);
  }
  guarantees.facet_angle = near.bad + away.bad;
  report.min_facet_angle_near_deg = near.least_angle_deg();
  report.min_facet_angle_away_deg = away.least_angle_deg();
  double max_ratio2 = 0;
  for_each_measured(mesh_, 0, mesh_.cells.size(), [&](std::size_t c, const Corners&, const CellMeasures& m) {
    if (!is_near(mesh_.cells[c])) return;
    ++report.cells_near;
    max_ratio2 = std::max(max_ratio2, m.squared_radius / m.shortest2);
  });
  if (report.cells_near > 0) report.max_radius_edge_near = std::sqrt(max_ratio2);
}

void measure_lines(const TetMesh& mesh, MeshingReport& report) {
  const std::vector<std::array<std::uint32_t, 2>> strays = stray_edges(mesh);
  for (const auto& [a, b] : strays)
    report.lines->stray_mm += std::sqrt(squared_distance(point_of(mesh, a), point_of(mesh, b)));
  NearLines(mesh, strays).measure(*report.lines, report.guarantees);
}

void measure_facets(const TetMesh& mesh, int threads, MeshingReport& report) {
  const auto add = [&](FacetTally& slice, std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto& facet = mesh.facets[f];
      slice.add(point_of(mesh, facet[0]), point_of(mesh, facet[1]), point_of(mesh, facet[2]));
    }
  };
  const FacetTally tally = tally_up(mesh.facets.size(), kMostSlices, threads, FacetTally{}, add);
  report.guarantees.facet_angle = tally.bad;
  report.quality.min_facet_angle_deg = angle_deg(tally.most_cotangent2);
  report.quality.max_facet_angle_deg = angle_deg(tally.least_cotangent2);
}

}  // namespace

void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes, int threads,
                     MeshingReport& report) {
  const CellTally cells = measure_cells(mesh, Bounds(sizes, image, mesh.space), threads, report);
  measure_facets(mesh, threads, report);
  if (report.lines) measure_lines(mesh, report);
  for (std::size_t label = 1; label < mesh.labels.size(); ++label) {
    const CellTally::OfLabel& of_label = cells.labels[label];
    report.cells_of_label[mesh.labels[label].value] = of_label.cells;
    report.volume_of_label_mm3[mesh.labels[label].value] = of_label.volume_mm3;
  }
  report.guarantees.missing_labels = missing_labels(image, report.cells_of_label, threads);
}

CellQualities qualities_of_cells(const TetMesh& mesh, int threads) {
  constexpr std::size_t kCellsAtATime = 1 << 14;
  const std::vector<double> zeros(mesh.cells.size());
  CellQualities all{zeros, zeros, zeros, zeros, zeros};
  const auto count = [&](std::size_t cell, const Corners& corners, CellMeasures m) {
    if (!is_positive(corners, m)) m.squared_radius = kInfinity;
    all.radius_edge[cell] = std::sqrt(m.squared_radius / m.shortest2);
    all.circumradius[cell] = std::sqrt(m.squared_radius);
    all.min_dihedral_deg[cell] = m.dihedral.least_deg();
    all.max_dihedral_deg[cell] = m.dihedral.largest_deg();
    all.volume[cell] = m.dihedral.determinant / 6;
  };
  parallel_for_ranges(
      mesh.cells.size(), kCellsAtATime, num_threads(threads),
      [&](std::size_t begin, std::size_t end, std::size_t) { for_each_measured(mesh, begin, end, count); });
  return all;
}

std::uint64_t missing_labels(const LabelImage& image,
                             const std::map<std::uint32_t, std::uint64_t>& cells_of_label, int threads) {
  const std::vector<std::uint64_t> voxels = count_voxels(image, threads);
  std::uint64_t count = 0;
  for (std::size_t label = 1; label < voxels.size(); ++label)
    count += voxels[label] > kLargeLabelVoxels && cells_of_label.at(image.labels[label].value) == 0;
  return count;
}

}  // namespace podm
