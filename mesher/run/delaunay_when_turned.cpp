#include "run/delaunay_when_turned.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/affine.h"
#include "geometry/predicates.h"
#include "image/working_frame.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr std::size_t kCellsAtATime = 1 << 11;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Axes of images that count as orthogonal may be off by less than this (working_frame.cpp).
constexpr double kShear = 4e-12;

// Returns the largest relative change of a length by turning. The caller of the library may give spacings
// that differ a little from those of the affine (algorithms/check_options.h).
double largest_stretch(const LabelImage& image) {
  double stretch = kShear;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Affine& a = image.voxel_to_ras;
    const double norm = std::hypot(a[axis], a[4 + axis], a[8 + axis]);
    stretch = std::max(stretch, kShear + std::fabs(norm / image.spacing[axis] - 1));
  }
  return stretch;
}
constexpr double kMostOfRadius = 1e-3;  // of tau in squared radii

// A sphere in the working frame, which passes through `vertex`.
struct Sphere {
  Point center, vertex;
  double radius_mm, det_mm3;

  Sphere(const Mesh& mesh, CellId c) : center(mesh.cell(c).center) {
    const auto& v = mesh.cell(c).vertices;
    vertex = mesh.point(v[0]);
    radius_mm = std::sqrt(squared_distance(center, vertex));
    det_mm3 = std::fabs(
        dot(cross(mesh.point(v[1]) - vertex, mesh.point(v[2]) - vertex), mesh.point(v[3]) - vertex));
  }
  double power_mm2(const Point& p) const { return dot(p - vertex, (p - center) + (vertex - center)); }
  double radius_over_det() const { return std::pow(radius_mm, 4) / det_mm3; }
  // The error of the center limits that of powers near the sphere.
  double error_mm2() const { return 2e3 * kEpsilon * radius_mm * radius_over_det(); }
};

class TurnedStore {
 public:
  TurnedStore(const Mesh& mesh, const LabelImage& image, int threads)
      : mesh_(mesh),
        image_(image),
        stretch_(largest_stretch(image)),
        threads_(num_threads(threads)),
        is_mirrored_(determinant(image.voxel_to_ras) < 0),
        is_used_(mesh.vertex_bound(), 0) {}

  bool is_delaunay() {
    find_largest_coordinate();
    for (CellId c = 0; c < mesh_.cell_bound(); ++c)
      if (is_output(c))
        for (const VertexId v : mesh_.cell(c).vertices) is_used_[v] = 1;
    std::atomic<double> tau_mm2 = 0;
    if (!holds_for_cells([&](CellId c) { return !is_output(c) || (is_positive(c) && raise(tau_mm2, c)); }))
      return false;
    tau_mm2_ = tau_mm2;
    return holds_for_cells([&](CellId c) { return all_are_outside(c); });
  }

 private:
  bool is_output(CellId c) const { return mesh_.cell(c).is_alive() && mesh_.label(c) != kBackground; }

  template <class Condition>
  bool holds_for_cells(const Condition& condition) const {
    std::atomic<bool> holds = true;
    parallel_for_ranges(
        mesh_.cell_bound(), kCellsAtATime, threads_, [&](std::size_t begin, std::size_t end, std::size_t) {
          for (std::size_t c = begin; c < end && holds; ++c)
            if (mesh_.cell(static_cast<CellId>(c)).is_alive() && !condition(static_cast<CellId>(c)))
              holds = false;
        });
    return holds;
  }

  void find_largest_coordinate() {
    const auto& [low, high] = mesh_.box();
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Point p{(corner & 1) != 0 ? low.x : high.x, (corner & 2) != 0 ? low.y : high.y,
                    (corner & 4) != 0 ? low.z : high.z};
      for (const Point& q : {p, turned(image_, p)})
        largest_mm_ = std::max({largest_mm_, std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)});
    }
  }

  // Raises tau to that of an output cell. Returns false if the cell is too flat.
  bool raise(std::atomic<double>& tau_mm2, CellId c) const {
    const Sphere sphere(mesh_, c);
    const double e_mm = 8 * kEpsilon * largest_mm_ + stretch_ * sphere.radius_mm;
    const double own_mm2 = 100 * e_mm * sphere.radius_over_det() + sphere.error_mm2();
    if (!(own_mm2 < kMostOfRadius * sphere.radius_mm * sphere.radius_mm)) return false;
    double known_mm2 = tau_mm2;
    while (known_mm2 < own_mm2 && !tau_mm2.compare_exchange_weak(known_mm2, own_mm2)) {
    }
    return true;
  }

  std::array<Point, 4> turned_points(CellId c) const {
    std::array<Point, 4> points;
    std::ranges::transform(mesh_.cell(c).vertices, points.begin(),
                           [&](VertexId v) { return turned(image_, mesh_.point(v)); });
    if (is_mirrored_) std::swap(points[2], points[3]);
    return points;
  }
  bool is_positive(CellId c) const {
    const auto [p, q, r, s] = turned_points(c);
    return orientation(p, q, r, s) > 0;
  }
  bool is_inside(VertexId v, CellId c) const {
    const auto [p, q, r, s] = turned_points(c);
    return in_circumsphere(p, q, r, s, turned(image_, mesh_.point(v)));
  }

  // Decides about the vertices beyond the facets of a cell.
  bool all_are_outside(CellId c) const {
    std::vector<CellId> near;
    for (const FacetId mirror : mesh_.cell(c).mirrors) {
      if (mirror == kNoFacet) continue;
      const VertexId v = mesh_.cell(cell_of(mirror)).vertices[mirror % 4];
      if (is_used_[v] != 0 && !is_outside_of_all(v, c, near)) return false;
    }
    return true;
  }

  // Walks from c to the cells whose spheres v is near.
  bool is_outside_of_all(VertexId v, CellId c, std::vector<CellId>& near) const {
    const Point& p = mesh_.point(v);
    near.assign(1, c);
    for (std::size_t i = 0; i < near.size(); ++i) {
      const Sphere sphere(mesh_, near[i]);
      if (sphere.power_mm2(p) > tau_mm2_ + sphere.error_mm2()) continue;
      if (is_output(near[i]) && is_inside(v, near[i])) return false;
      for (const FacetId mirror : mesh_.cell(near[i]).mirrors) {
        if (mirror == kNoFacet) continue;
        const CellId next = cell_of(mirror);
        const bool has_vertex =
            std::ranges::find(mesh_.cell(next).vertices, v) != mesh_.cell(next).vertices.end();
        if (!has_vertex && std::ranges::find(near, next) == near.end()) near.push_back(next);
      }
    }
    return true;
  }

  const Mesh& mesh_;
  const LabelImage& image_;
  const double stretch_;
  std::size_t threads_;
  bool is_mirrored_;
  std::vector<char> is_used_;  // by vertex: by a cell of the output
  double largest_mm_ = 0, tau_mm2_ = 0;
};

}  // namespace

Point turned(const LabelImage& image, const Point& p) {
  const auto& s = image.spacing;
  return map_accurately(image.voxel_to_ras, {p.x / s[0], p.y / s[1], p.z / s[2]});
}

bool is_delaunay_when_turned(const Mesh& mesh, const LabelImage& image, int threads) {
  return TurnedStore(mesh, image, threads).is_delaunay();
}

}  // namespace podm
