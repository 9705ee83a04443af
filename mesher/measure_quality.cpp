#include "measure_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cost_model.h"
#include "geometry/circumsphere.h"
#include "geometry/predicates.h"
#include "geometry/tetrahedron.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kLargeLabelVoxels = 1000;  // larger labels must appear
constexpr double kRadToDeg = 180 / std::numbers::pi;

Point point_of(const TetMesh& mesh, std::uint32_t v) {
  return {mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
}

double angle_deg(const Vector& u, const Vector& v) {
  return std::atan2(std::sqrt(squared_length(cross(u, v))), dot(u, v)) * kRadToDeg;
}

// The square of the angle's cotangent, with its sign: falls as the angle grows, and costs neither a root nor
// an arc tangent, so that these are left for the extremes alone.
double squared_cotangent(const Vector& u, const Vector& v) {
  const double along = dot(u, v);
  return along * std::abs(along) / squared_length(cross(u, v));
}
double angle_deg(double squared_cotangent) {
  return std::atan2(1, std::copysign(std::sqrt(std::abs(squared_cotangent)), squared_cotangent)) * kRadToDeg;
}

// What the items of a slice add up to. Any thread adds up a slice; slices are put together in their order, so
// that sums are rounded alike on any number of threads.
template <class Tally, class Add>
Tally tally_up(std::size_t num_items, std::size_t num_slices, int threads, const Tally& none,
               const Add& add) {
  const std::size_t length = (num_items + num_slices - 1) / num_slices;
  std::vector<Tally> slices(num_slices, none);
  parallel_for(num_slices, num_threads(threads), [&](std::size_t slice, std::size_t) {
    const std::size_t end = std::min(num_items, (slice + 1) * length);
    for (std::size_t i = slice * length; i < end; ++i) add(slices[slice], i);
  });
  for (std::size_t slice = 1; slice < num_slices; ++slice) slices[0] += slices[slice];
  return std::move(slices[0]);
}

constexpr std::size_t kMostSlices = 256;

struct alignas(64) CellTally {
  struct OfLabel {
    double volume_mm3 = 0;
    std::uint64_t cells = 0;
  };

  double max_ratio2 = 0, max_radius2 = 0, shortest2 = kInfinity;
  // The angles are those between facets' normals, which dihedral angles make up to 180 degrees.
  double least_cotangent2 = kInfinity, most_cotangent2 = -kInfinity;
  std::uint64_t bad_orientation = 0, bad_radius_edge = 0, bad_radius = 0;
  std::vector<OfLabel> labels;

  void add(const std::array<Point, 4>& p, LabelIndex label, double squared_radius_bound) {
    if (orientation(p[0], p[1], p[2], p[3]) <= 0) {
      ++bad_orientation;
      return;
    }
    const Circumsphere sphere = circumsphere(p[0], p[1], p[2], p[3], 0);
    double shortest_of_cell2 = kInfinity;
    for (const auto& e : kEdgeVertices) {
      const double length2 = squared_distance(p[static_cast<unsigned>(e[0])], p[static_cast<unsigned>(e[1])]);
      shortest_of_cell2 = std::min(shortest_of_cell2, length2);
    }
    const double ratio2 = sphere.squared_radius / shortest_of_cell2;
    bad_radius_edge += ratio2 >= kRadiusEdgeBound * kRadiusEdgeBound;
    bad_radius += sphere.squared_radius > squared_radius_bound;
    max_ratio2 = std::max(max_ratio2, ratio2);
    max_radius2 = std::max(max_radius2, sphere.squared_radius);
    shortest2 = std::min(shortest2, shortest_of_cell2);
    add_dihedrals(p);
    labels[label].volume_mm3 += dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6;
    ++labels[label].cells;
  }

  // Dihedral angle at an edge: between the facets opposite its complement's ends.
  void add_dihedrals(const std::array<Point, 4>& p) {
    std::array<Vector, 4> inward;
    for (unsigned i = 0; i < 4; ++i) {
      const auto& k = kFacetVertices[i];
      const Point& o = p[static_cast<unsigned>(k[0])];
      inward[i] = cross(p[static_cast<unsigned>(k[1])] - o, p[static_cast<unsigned>(k[2])] - o);
    }
    for (const auto& pair : kEdgeVertices) {
      const double outer =
          squared_cotangent(inward[static_cast<unsigned>(pair[0])], inward[static_cast<unsigned>(pair[1])]);
      least_cotangent2 = std::min(least_cotangent2, outer);
      most_cotangent2 = std::max(most_cotangent2, outer);
    }
  }

  void operator+=(const CellTally& b) {
    max_ratio2 = std::max(max_ratio2, b.max_ratio2);
    max_radius2 = std::max(max_radius2, b.max_radius2);
    shortest2 = std::min(shortest2, b.shortest2);
    least_cotangent2 = std::min(least_cotangent2, b.least_cotangent2);
    most_cotangent2 = std::max(most_cotangent2, b.most_cotangent2);
    bad_orientation += b.bad_orientation;
    bad_radius_edge += b.bad_radius_edge;
    bad_radius += b.bad_radius;
    for (std::size_t label = 0; label < labels.size(); ++label) {
      labels[label].volume_mm3 += b.labels[label].volume_mm3;
      labels[label].cells += b.labels[label].cells;
    }
  }
};

CellTally measure_cells(const TetMesh& mesh, const SizeField& sizes, int threads, MeshingReport& report) {
  CellTally none;
  none.labels.resize(mesh.labels.size());
  // No more than what lets the sums of all labels take 4 bytes a cell.
  const std::size_t num_slices =
      std::clamp<std::size_t>(mesh.cells.size() / (4 * mesh.labels.size()), 1, kMostSlices);
  CellTally tally =
      tally_up(mesh.cells.size(), num_slices, threads, none, [&](CellTally& slice, std::size_t c) {
        std::array<Point, 4> p;
        for (unsigned i = 0; i < 4; ++i) p[i] = point_of(mesh, mesh.cells[c][i]);
        slice.add(p, mesh.cell_labels[c], sizes.squared_radius(mesh.cell_labels[c]));
      });
  report.guarantees.orientation = tally.bad_orientation;
  report.guarantees.radius_edge = tally.bad_radius_edge;
  report.guarantees.radius = tally.bad_radius;
  report.quality.max_radius_edge = std::sqrt(tally.max_ratio2);
  report.quality.max_radius_mm = std::sqrt(tally.max_radius2);
  report.quality.shortest_edge_mm = tally.shortest2 < kInfinity ? std::sqrt(tally.shortest2) : 0;
  report.quality.min_dihedral_deg = angle_deg(-tally.least_cotangent2);
  report.quality.max_dihedral_deg = angle_deg(-tally.most_cotangent2);
  return tally;
}

struct alignas(64) FacetTally {
  double smallest = 180, largest = 0;
  std::uint64_t bad = 0;

  void add(const Point& a, const Point& b, const Point& c) {
    const std::array<double, 3> angles{angle_deg(b - a, c - a), angle_deg(c - b, a - b),
                                       angle_deg(a - c, b - c)};
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    bad += *least <= kFacetAngleBound;
    smallest = std::min(smallest, *least);
    largest = std::max(largest, *most);
  }
  void operator+=(const FacetTally& b) {
    smallest = std::min(smallest, b.smallest);
    largest = std::max(largest, b.largest);
    bad += b.bad;
  }
};

void measure_facets(const TetMesh& mesh, int threads, MeshingReport& report) {
  const auto add = [&](FacetTally& slice, std::size_t f) {
    const auto& facet = mesh.facets[f];
    slice.add(point_of(mesh, facet[0]), point_of(mesh, facet[1]), point_of(mesh, facet[2]));
  };
  const FacetTally tally = tally_up(mesh.facets.size(), kMostSlices, threads, FacetTally{}, add);
  report.guarantees.facet_angle = tally.bad;
  report.quality.min_facet_angle_deg = tally.smallest;
  report.quality.max_facet_angle_deg = tally.largest;
}

}  // namespace

void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes, int threads,
                     MeshingReport& report) {
  const CellTally cells = measure_cells(mesh, sizes, threads, report);
  measure_facets(mesh, threads, report);
  const std::vector<std::uint64_t> voxels = count_voxels(image, threads);
  for (std::size_t label = 1; label < mesh.labels.size(); ++label) {
    const CellTally::OfLabel& of_label = cells.labels[label];
    report.cells_of_label[mesh.labels[label].value] = of_label.cells;
    report.volume_of_label_mm3[mesh.labels[label].value] = of_label.volume_mm3;
    report.guarantees.missing_labels += voxels[label] > kLargeLabelVoxels && of_label.cells == 0;
  }
}

}  // namespace podm
