// Claim box.
//   Statements  The box of the image is flat: its six sides, the planes of the outermost voxels' outer faces,
//               end the object. First, a vertex of the mesh's boundary within 0.0005 voxels of a side is in
//               its plane: exactly, on one coordinate, if the image's axes are parallel to those of the file,
//               otherwise within 2 units in the last place of the box's largest coordinate. Second, a
//               boundary facet with a vertex on a side lies in the plane of a side, unless each such vertex
//               is within a voxel's diagonal, or 2 delta (--delta), of a voxel of background: there
//               the boundary may go on into the box. Third, on each side the facets in its plane have at
//               least the area of the labelled voxels there that are not so near to background, less 5 %, and
//               at most that of all labelled voxels, plus 5 % and half a strip of the width of a voxel's
//               diagonal, or of delta, along the border of the labels. Fourth, likewise with lengths along
//               each edge of the box, to 1 % and twice that width for each end of the labels. The boundary
//               consists of the facets with one cell.
//   Rests on    The labels of the outermost voxels. Areas and lengths of labels are those of the faces and
//               edges of these voxels. Distances of vertices are exact, areas and lengths are rounded.
//   Cost        Linear in the boundary facets and in the voxels at the border; 10 us for each vertex on a
//               side in a frame that is not parallel, and for facets beside background the voxels within
//               reach.
//   Not proved  That the boundary in the plane has the shape of the labels there: fidelity measures it, and
//               lines the curves between labels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "claims/check_surface_boundary.h"
#include "claims/claims.h"
#include "claims/sides_of_vertices.h"
#include "claims/tally.h"

namespace podm::verify {

namespace {

constexpr double kAreaShare = 0.05, kLengthShare = 0.01;

using EdgeOfBox = std::array<std::size_t, 2>;  // its two sides

double norm(const Point& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

Point way(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

double area_of(const Point& a, const Point& b, const Point& c) {
  return 0.5 * norm(cross(way(b, a), way(c, a)));
}

bool has(SideSet sides, std::size_t side) { return (sides >> side & 1) != 0; }

// The range of the area on a side, or of the length along an edge of the box, that the image's labels allow.
struct Expected {
  double least = 0, most = 0;  // mm^2 or mm

  bool admits(double found, double share) const {
    return found >= (1 - share) * least && found <= (1 + share) * most;
  }
};

class BoxOfImage {
 public:
  BoxOfImage(const Image& image, double delta_mm)
      : image_(image), delta_mm_(delta_mm), width_mm_(std::max(delta_mm, diagonal(image))) {}

  // True if a voxel of background has its center within reach of u.
  bool is_beside_background(const Point& u) const {
    const double reach_mm = std::max(width_mm_, 2 * delta_mm_);
    std::array<int, 3> low{}, high{}, v{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double reach = reach_mm / image_.spacing[axis];
      low[axis] = std::max(0, static_cast<int>(std::ceil(u[axis] - reach)));
      high[axis] = std::min(image_.size[axis] - 1, static_cast<int>(std::floor(u[axis] + reach)));
    }
    for (v[2] = low[2]; v[2] <= high[2]; ++v[2])
      for (v[1] = low[1]; v[1] <= high[1]; ++v[1])
        for (v[0] = low[0]; v[0] <= high[0]; ++v[0])
          if (label(v) == 0 && distance_mm(u, v) <= reach_mm) return true;
    return false;
  }

  // Faces of voxels beside background may be in the mesh, and so may half a strip along the border of others.
  Expected on_side(std::size_t side) const {
    const std::size_t axis = side / 2, first = (axis + 1) % 3, second = (axis + 2) % 3;
    const double face = image_.spacing[first] * image_.spacing[second];
    Expected found;
    std::array<int, 3> v{};
    v[axis] = border(side);
    for (v[second] = 0; v[second] < image_.size[second]; ++v[second])
      for (v[first] = 0; v[first] < image_.size[first]; ++v[first]) {
        if (label(v) == 0) continue;
        found.most += face + strip_beside(v, first, second) + strip_beside(v, second, first);
        found.least += is_solid(v) ? face : 0;
      }
    return found;
  }

  Expected along(const EdgeOfBox& edge) const {
    const std::size_t a = edge[0] / 2, b = edge[1] / 2, along = 3 - a - b;
    Expected found;
    std::array<int, 3> v{};
    v[a] = border(edge[0]);
    v[b] = border(edge[1]);
    for (v[along] = 0; v[along] < image_.size[along]; ++v[along]) {
      if (label(v) == 0) continue;
      found.most += image_.spacing[along] + 2 * width_mm_ * num_background_beside(v, along);
      found.least += is_solid(v) ? image_.spacing[along] : 0;
    }
    return found;
  }

 private:
  static double diagonal(const Image& image) {
    return std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
  }
  double distance_mm(const Point& u, const std::array<int, 3>& v) const {
    Point d;
    for (std::size_t axis = 0; axis < 3; ++axis) d[axis] = (v[axis] - u[axis]) * image_.spacing[axis];
    return norm(d);
  }
  int border(std::size_t side) const { return (side & 1) == 0 ? 0 : image_.size[side / 2] - 1; }
  bool is_solid(const std::array<int, 3>& v) const {
    return !is_beside_background(
        {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])});
  }
  // The number of neighbours of a voxel along an axis that are background in the grid.
  int num_background_beside(std::array<int, 3> v, std::size_t axis) const {
    int count = 0;
    for (const int step : {-1, 2}) {
      v[axis] += step;
      count += v[axis] >= 0 && v[axis] < image_.size[axis] && label(v) == 0;
    }
    return count;
  }
  double strip_beside(const std::array<int, 3>& v, std::size_t axis, std::size_t along) const {
    return 0.5 * width_mm_ * image_.spacing[along] * num_background_beside(v, axis);
  }
  std::uint32_t label(const std::array<int, 3>& v) const {
    const auto at = [&](std::size_t i) { return static_cast<std::size_t>(v[i]); };
    const auto n = [&](std::size_t i) { return static_cast<std::size_t>(image_.size[i]); };
    return image_.voxels[(at(2) * n(1) + at(1)) * n(0) + at(0)];
  }
  const Image& image_;
  double delta_mm_, width_mm_;
};

class BoxCheck {
 public:
  BoxCheck(const Mesh& mesh, const Adjacency& adjacency, const Image& image, const Options& options)
      : mesh_(mesh),
        frame_(image, mesh.space),
        sides_(image, frame_, mesh.space),
        box_(image, options.delta_mm.value_or(0)),
        label_indices_(mesh),
        facets_(find_sides(mesh, adjacency, label_indices_, num_threads(options.threads))),
        sides_of_vertex_(mesh.vertices.size()) {}

  Tally operator()() {
    for (const Side& facet : facets_)
      if (facet.across == 0)
        for (const VertexId v : facet.vertices) check_vertex(v);
    for (const Side& facet : facets_)
      if (facet.across == 0) check_facet(facet);
    for (std::size_t side = 0; side < kNumSides; ++side) check_area(side);
    for (std::size_t one = 0; one < kNumSides; ++one)
      for (std::size_t other = one + 1; other < kNumSides; ++other)
        if (one / 2 != other / 2) check_length({one, other});
    return tally_;
  }

  nlohmann::json facets_of_sides() const {
    nlohmann::json counts;
    for (std::size_t side = 0; side < kNumSides; ++side) counts[kSideNames[side]] = num_facets_[side];
    return counts;
  }
  double most_ulps_off() const { return most_ulps_off_; }
  std::uint64_t facets_off() const { return num_off_; }

 private:
  static constexpr SideSet kSeen = 1U << 7;

  // Statement 1.
  void check_vertex(VertexId v) {
    SideSet& sides = sides_of_vertex_[v];
    if ((sides & kSeen) != 0) return;
    const Point& p = mesh_.vertices[v];
    sides = sides_.near(p) | kSeen;
    for (std::size_t side = 0; side < kNumSides; ++side) {
      if (!has(sides, side)) continue;
      ++tally_.num_checked;
      const double ulps = sides_.ulps_off(p, side, tally_.num_exact);
      most_ulps_off_ = std::max(most_ulps_off_, ulps);
      if (ulps <= sides_.most_ulps() && has_coordinate_of(side, p)) continue;
      tally_.violation({.statement = "a vertex at a side of the box is in its plane",
                        .vertices = {global_vertex(mesh_, v)},
                        .points = {p},
                        .value = ulps,
                        .severity = ulps});
    }
  }

  // In a parallel frame the vertices on a side have one coordinate.
  bool has_coordinate_of(std::size_t side, const Point& p) {
    if (!sides_.is_parallel()) return true;
    const double at = p[sides_.row_of(side)];
    if (!coordinates_[side]) coordinates_[side] = at;
    return *coordinates_[side] == at;
  }

  // Statement 2, and the sums for statements 3 and 4.
  void check_facet(const Side& facet) {
    ++tally_.num_checked;
    unsigned common = ~kSeen & 0xffU, any = 0;
    for (const VertexId v : facet.vertices) {
      common &= sides_of_vertex_[v];
      any |= sides_of_vertex_[v] & ~static_cast<unsigned>(kSeen);
    }
    if (common != 0) return add(facet, static_cast<SideSet>(common));
    if (any == 0 || is_beside_background(facet)) return;
    ++num_off_;
    Witness witness{.statement = "a boundary facet at a side of the box lies in its plane",
                    .cells = {global_cell(mesh_, facet.cell)},
                    .severity = 1};
    for (const VertexId v : facet.vertices) {
      witness.vertices.push_back(global_vertex(mesh_, v));
      witness.points.push_back(mesh_.vertices[v]);
    }
    tally_.violation(std::move(witness));
  }

  bool is_beside_background(const Side& facet) const {
    return std::all_of(facet.vertices.begin(), facet.vertices.end(), [&](VertexId v) {
      return (sides_of_vertex_[v] & ~kSeen) == 0 ||
             box_.is_beside_background(frame_.to_voxels(mesh_.vertices[v]));
    });
  }

  void add(const Side& facet, SideSet common) {
    std::array<Point, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = frame_.to_world(mesh_.vertices[facet.vertices[i]]);
    for (std::size_t side = 0; side < kNumSides; ++side) {
      if (!has(common, side)) continue;
      ++num_facets_[side];
      area_[side] += area_of(p[0], p[1], p[2]);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const SideSet both = sides_of_vertex_[facet.vertices[i]] & sides_of_vertex_[facet.vertices[j]];
        for (std::size_t other = side + 1; other < kNumSides; ++other)
          if (has(both, other)) length_[{side, other}] += norm(way(p[i], p[j]));
      }
    }
  }

  // Statement 3.
  void check_area(std::size_t side) {
    judge(area_[side], box_.on_side(side), kAreaShare, [&](const Expected& expected) {
      return fmt::format("the facets on side {} have the area of its labels, {:.6g} to {:.6g} mm^2",
                         kSideNames[side], expected.least, expected.most);
    });
  }

  // Statement 4.
  void check_length(const EdgeOfBox& edge) {
    judge(length_[edge], box_.along(edge), kLengthShare, [&](const Expected& expected) {
      return fmt::format(
          "the edges of the mesh along {} and {} have the length of the labels, {:.6g} to {:.6g} mm",
          kSideNames[edge[0]], kSideNames[edge[1]], expected.least, expected.most);
    });
  }

  template <class Statement>
  void judge(double found, const Expected& expected, double share, const Statement& statement) {
    ++tally_.num_checked;
    if (expected.admits(found, share)) return;
    tally_.violation({.statement = statement(expected),
                      .value = found,
                      .severity = std::max(expected.least - found, found - expected.most)});
  }

  const Mesh& mesh_;
  ImageFrame frame_;
  SidesOfVertices sides_;
  BoxOfImage box_;
  CellLabelIndices label_indices_;
  std::vector<Side> facets_;
  std::vector<SideSet> sides_of_vertex_;
  std::array<std::optional<double>, kNumSides> coordinates_;
  std::array<std::uint64_t, kNumSides> num_facets_{};
  std::array<double, kNumSides> area_{};
  std::map<EdgeOfBox, double> length_;
  double most_ulps_off_ = 0;
  std::uint64_t num_off_ = 0;
  Tally tally_;
};

}  // namespace

ClaimResult check_box(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                      const Options& options) {
  ClaimResult result;
  result.claim = "box";
  if (!image.is_box_flat) {
    result.reason = "the box is open: neither the file nor --box says that it is flat";
    return result;
  }
  if (mesh.part != nullptr) {
    result.reason = "not on ranks";
    return result;
  }
  BoxCheck check(mesh, adjacency, image, options);
  const Tally tally = check();
  result = result_of("box", tally);
  result.method = "exact distances from planes; rounded areas and lengths";
  result.reason = fmt::format(
      "{} violations; facets on sides, vertices up to {:.3g} units in the last place off; {} facets leave a "
      "side",
      tally.num_violations, check.most_ulps_off(), check.facets_off());
  result.details() = {{"facets_of_sides", check.facets_of_sides()},
                      {"most_ulps_off", check.most_ulps_off()},
                      {"facets_off_sides", check.facets_off()}};
  return result;
}

}  // namespace podm::verify
