// Claim boundary_angles.
//   Statement   Every planar angle of every boundary facet, between a cell and the outside or between cells
//               of different labels, exceeds the bound (by default 30 degrees). If the mesh keeps lines
//               (near_lines.h), angles of facets near lines need only exceed the angle of 20.7 degrees whose
//               sine is 1 / (2 sqrt 2), or the bound if that is less. Such a facet has a circumradius below
//               sqrt 2 times its shortest edge: the mesher splits other ones until a line stops it.
//   Rests on    A facet's smallest angle t is between its two longest edges m and n and is at most 60
//               degrees. With A the area, 2 A = m n sin t. So t > bound exactly if
//               4 A^2 > max(m^2 n^2) sin^2(bound). The bound is the decimal number as typed, or 90 degrees if
//               it is more. sin^2 is 1/8 near lines, and otherwise exact or above the true value by less than
//               1e-70 (squared_sine); a facet in that gap would count as a violation. Interval arithmetic
//               decides the clear facets, rationals the rest.
//   Cost        Linear in the boundary facets.
//   Not proved  Anything about angles inside a label. Facets that only the file lists are not checked. Nor
//               that the lines of the mesh are the image's, which the claim lines judges. Facets near lines
//               are counted, and those that only the weaker bound admits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "claims/claims.h"
#include "claims/near_lines.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

constexpr double kSquaredSineNearLines = 0.125;

// Returns the sign of the facet's smallest angle minus the bound.
int side_of_bound(const TrianglePoints& p, const Constant& sine2, std::uint64_t& num_exact) {
  return sign_of(
      [&]<class T>(T) {
        const T a = squared_length<T>(p[1], p[2]), b = squared_length<T>(p[2], p[0]),
                c = squared_length<T>(p[0], p[1]);
        return squared_double_area<T>(p) - sine2.in<T>() * larger<T>(larger<T>(a * b, b * c), c * a);
      },
      num_exact);
}

bool is_boundary(const Mesh& mesh, FacetId f, FacetId mirror) {
  if (mirror == kNone) return true;
  return f < mirror && !mesh.cell_labels.empty() && mesh.cell_labels[f / 4] != mesh.cell_labels[mirror / 4];
}

struct AngleTally : Tally {
  std::uint64_t num_near = 0, num_excused = 0;  // near lines; of these, those that the bound itself refutes
  double least_near = std::numeric_limits<double>::infinity(), least_elsewhere = least_near;

  void add(const AngleTally& other) {
    Tally::add(other);
    num_near += other.num_near;
    num_excused += other.num_excused;
    least_near = std::min(least_near, other.least_near);
    least_elsewhere = std::min(least_elsewhere, other.least_elsewhere);
  }
  template <class Stream>
  void transfer(Stream& stream) {
    Tally::transfer(stream);
    stream(num_near, num_excused, least_near, least_elsewhere);
  }
};

class Facets {
 public:
  Facets(const Mesh& mesh, const Adjacency& adjacency, const Options& options)
      : mesh_(mesh),
        near_lines_(mesh, adjacency, options),
        bound_deg_(options.angle_bound_deg),
        bound_near_lines_deg_(
            std::min(bound_deg_, std::asin(std::sqrt(kSquaredSineNearLines)) * 180 / std::numbers::pi)),
        sine2_(squared_sine(decimal_as_typed(std::min(bound_deg_, 90.0)))),
        sine2_near_lines_(smaller(sine2_.in<Rational>(), Rational(kSquaredSineNearLines))) {}

  bool keep_lines() const { return near_lines_.are_kept(); }
  double bound_near_lines_deg() const { return bound_near_lines_deg_; }

  void check(FacetId f, AngleTally& tally) const {
    const auto vertices = vertices_of(mesh_, f);
    const TrianglePoints p = points_of(mesh_, vertices);
    const auto angles = angles_deg(p);
    for (const double angle : angles) tally.bins[0].add(angle);
    const double least = *std::min_element(angles.begin(), angles.end());
    const bool is_near = near_lines_.has(vertices);
    ++tally.num_checked;
    tally.num_near += is_near;
    double& least_there = is_near ? tally.least_near : tally.least_elsewhere;
    least_there = std::min(least_there, least);
    int side = side_of_bound(p, sine2_, tally.num_exact);
    if (is_near && side <= 0) {
      side = side_of_bound(p, sine2_near_lines_, tally.num_exact);
      tally.num_excused += side > 0;
    }
    tally.num_ties += side == 0;
    const double severity = (is_near ? bound_near_lines_deg_ : bound_deg_) - least;
    if (side <= 0) {
      tally.violation(witness(f,
                              side == 0 ? "angles exceed the bound (equal to it)"
                              : is_near ? "angles exceed the bound near lines"
                                        : "angles exceed the bound",
                              least, severity));
    } else if (tally.closest.wants(severity)) {
      tally.closest.add(witness(f, "angles exceed the bound", least, severity));
    }
  }

 private:
  Witness witness(FacetId f, const char* statement, double least, double severity) const {
    const auto vertices = vertices_of(mesh_, f);
    const TrianglePoints p = points_of(mesh_, vertices);
    return {.statement = statement,
            .cells = {global_cell(mesh_, f / 4)},
            .vertices = global_vertices(mesh_, vertices),
            .points = {p.begin(), p.end()},
            .value = least,
            .severity = severity,
            .label = mesh_.cell_labels.empty() ? 0 : mesh_.cell_labels[f / 4]};
  }

  const Mesh& mesh_;
  NearLines near_lines_;
  double bound_deg_, bound_near_lines_deg_;
  Constant sine2_, sine2_near_lines_;
};

nlohmann::json near_lines_to_json(const AngleTally& tally, double bound_deg) {
  return {{"facets", tally.num_near},
          {"excused", tally.num_excused},
          {"bound_degrees", bound_deg},
          {"smallest_degrees", tally.num_near > 0 ? nlohmann::json(tally.least_near) : nlohmann::json()}};
}

// Returns the text about the smallest angles.
std::string smallest_of(const AngleTally& tally, double bound_deg) {
  std::string text;
  if (tally.num_checked > tally.num_near) text += fmt::format("; smallest {:.6g}", tally.least_elsewhere);
  if (tally.num_near > 0)
    text += fmt::format("; of {} facets near lines {:.6g}, {} at or under {}", tally.num_near,
                        tally.least_near, tally.num_excused, bound_deg);
  return text;
}

}  // namespace

ClaimResult check_boundary_angles(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  AngleTally empty;
  empty.bins.emplace_back("boundary_facet_angle", "degrees", 0, 180, 72);
  const Facets facets(mesh, adjacency, options);
  const AngleTally tally = over_ranks(
      mesh, tally_over(own_facets(mesh), options.threads, empty, [&](std::size_t i, AngleTally& part) {
        const auto f = static_cast<FacetId>(i);
        if (is_boundary(mesh, f, adjacency.mirror[f])) facets.check(f, part);
      }));
  ClaimResult result = result_of("boundary_angles", tally);
  result.method = "interval arithmetic, then rationals";
  result.details()["bound_degrees"] = options.angle_bound_deg;
  result.details()["facets_equal_to_bound"] = tally.num_ties;
  result.reason = fmt::format("{} of {} facets with an angle at or under {} degrees", result.num_violations,
                              result.num_checked, options.angle_bound_deg);
  if (facets.keep_lines()) {
    result.details()["near_lines"] = near_lines_to_json(tally, facets.bound_near_lines_deg());
    result.reason += fmt::format(", near lines {:.4g}", facets.bound_near_lines_deg());
  }
  result.reason += smallest_of(tally, options.angle_bound_deg);
  return result;
}

}  // namespace podm::verify
