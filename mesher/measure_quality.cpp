#include "measure_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/circumsphere.h"
#include "geometry/predicates.h"
#include "geometry/tetrahedron.h"

namespace podm {

namespace {

constexpr std::uint64_t kLargeLabelVoxels = 1000;  // larger labels must appear
constexpr double kRadToDeg = 180 / std::numbers::pi;

Point point_of(const TetMesh& mesh, std::uint32_t v) {
  return {mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
}

double angle_deg(const Vector& u, const Vector& v) {
  return std::atan2(std::sqrt(squared_length(cross(u, v))), dot(u, v)) * kRadToDeg;
}

struct Extremes {
  double max_ratio2 = 0, max_radius2 = 0, shortest2 = std::numeric_limits<double>::infinity();
  double min_dihedral = 180, max_dihedral = 0;

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
          angle_deg(inward[static_cast<unsigned>(pair[0])], inward[static_cast<unsigned>(pair[1])]);
      min_dihedral = std::min(min_dihedral, 180 - outer);
      max_dihedral = std::max(max_dihedral, 180 - outer);
    }
  }
};

void measure_cells(const TetMesh& mesh, const SizeField& sizes, MeshingReport& report,
                   std::vector<double>& volumes, std::vector<std::uint64_t>& counts) {
  Extremes extremes;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    std::array<Point, 4> p;
    for (unsigned i = 0; i < 4; ++i) p[i] = point_of(mesh, mesh.cells[c][i]);
    if (orientation(p[0], p[1], p[2], p[3]) <= 0) {
      ++report.guarantees.orientation;
      continue;
    }
    const Circumsphere sphere = circumsphere(p[0], p[1], p[2], p[3], 0);
    double shortest2 = std::numeric_limits<double>::infinity();
    for (const auto& e : kEdgeVertices) {
      shortest2 = std::min(shortest2,
                           squared_distance(p[static_cast<unsigned>(e[0])], p[static_cast<unsigned>(e[1])]));
    }
    const LabelIndex label = mesh.cell_labels[c];
    const double ratio2 = sphere.squared_radius / shortest2;
    report.guarantees.radius_edge += ratio2 >= kRadiusEdgeBound * kRadiusEdgeBound;
    report.guarantees.radius += sphere.squared_radius > sizes.squared_radius(label);
    extremes.max_ratio2 = std::max(extremes.max_ratio2, ratio2);
    extremes.max_radius2 = std::max(extremes.max_radius2, sphere.squared_radius);
    extremes.shortest2 = std::min(extremes.shortest2, shortest2);
    extremes.add_dihedrals(p);
    volumes[label] += dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6;
    ++counts[label];
  }
  report.quality.max_radius_edge = std::sqrt(extremes.max_ratio2);
  report.quality.max_radius_mm = std::sqrt(extremes.max_radius2);
  report.quality.shortest_edge_mm = mesh.cells.empty() ? 0 : std::sqrt(extremes.shortest2);
  report.quality.min_dihedral_deg = extremes.min_dihedral;
  report.quality.max_dihedral_deg = extremes.max_dihedral;
}

void measure_facets(const TetMesh& mesh, MeshingReport& report) {
  double smallest = 180, largest = 0;
  for (const auto& facet : mesh.facets) {
    const Point a = point_of(mesh, facet[0]), b = point_of(mesh, facet[1]), c = point_of(mesh, facet[2]);
    const std::array<double, 3> angles{angle_deg(b - a, c - a), angle_deg(c - b, a - b),
                                       angle_deg(a - c, b - c)};
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    report.guarantees.facet_angle += *least <= kFacetAngleBound;
    smallest = std::min(smallest, *least);
    largest = std::max(largest, *most);
  }
  report.quality.min_facet_angle_deg = smallest;
  report.quality.max_facet_angle_deg = largest;
}

}  // namespace

void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes,
                     MeshingReport& report) {
  std::vector<double> volumes(mesh.labels.size(), 0.0);
  std::vector<std::uint64_t> counts(mesh.labels.size(), 0), voxels(mesh.labels.size(), 0);
  measure_cells(mesh, sizes, report, volumes, counts);
  measure_facets(mesh, report);
  for (const LabelIndex label : image.voxels) ++voxels[label];
  for (std::size_t label = 1; label < mesh.labels.size(); ++label) {
    report.cells_of_label[mesh.labels[label].value] = counts[label];
    report.volume_of_label_mm3[mesh.labels[label].value] = volumes[label];
    report.guarantees.missing_labels += voxels[label] > kLargeLabelVoxels && counts[label] == 0;
  }
}

}  // namespace podm
