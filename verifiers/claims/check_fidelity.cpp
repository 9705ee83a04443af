// Claim fidelity.
//   Statements  Let b be the bound. First, 95 % of the mesh's label interface, by area, lies within b voxels
//               of the image's. Second, all of it lies within sqrt(3) b, the diagonal of a voxel. Third, 95 %
//               of the image's interface, by area, lies within b voxels of the mesh's. The mesh's interface
//               consists of the facets between cells of different labels and the facets with one cell. The
//               image's interface is where its label function changes (image/label_function.h), not the
//               staircase of its voxels. For a smoothed image (image/smoothing.h) it is the smoothed
//               interface.
//               b is 1 (Options::fidelity_bound_voxels), as the image leaves open where a label ends between
//               the centers of two voxels. A mesh of the PODM family that was made with the sampling distance
//               delta (Options::delta_mm) promises less if delta is coarser: a distance within 2 delta counts
//               as within sqrt(3) b, and one within 2 delta / sqrt(3) as within b. The second statement is
//               proved for such a mesh. The Voronoi edge of an interface facet crosses the isosurface in the
//               circumball of a cell of the facet. Rule R2 left no such ball a radius of 2 delta. R3 has the
//               facet's vertices on the isosurface. No point of a triangle is further from all of its
//               vertices than its circumradius.
//   Rests on    Samples of both interfaces. The samples of the mesh are points less than half a voxel apart,
//               vertices and points of edges among them: between samples a facet is at most 0.3 voxels
//               further away than the samples are. The samples of the image lie between the centers of two
//               voxels of different labels that share a face, at the point where the label changes, which is
//               halfway if the image is not smoothed. They are exact points of the interface up to rounding,
//               each weighted by the area of its face. Distances are lengths in mm in the world, so
//               anisotropic spacing and shear are taken into account. The same displacements are measured in
//               voxel indices for distances "in voxels". The distance to a facet is exact up to rounding. The
//               distance to the image's interface is the distance to a point found on it, never too small
//               (check_fidelity_isosurface.h).
//   Cost        (samples + facets) log n; about 5 us per sample, 60 bytes per facet and 50 per voxel face. A
//               smoothed image takes twice the time for the samples of the mesh, and twice the bytes for
//               faces.
//   Not proved  That each structure of the image is there: structures thinner than the sampling of the mesh
//               may be lost. Nor topology, which the claim surface reports. Mean, 95 % and maximum are
//               reported both ways, for all together and per label (between the boundary of the label's cells
//               and that of its voxels), and for the mesh's interface vertices alone, which the claim
//               surface_vertices judges. The distances from the mesh's interface to the interface of the
//               image before it was smoothed are reported, not judged.
#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "claims/check_fidelity_distribution.h"
#include "claims/check_fidelity_facets.h"
#include "claims/check_fidelity_isosurface.h"
#include "claims/check_fidelity_nearest.h"
#include "claims/claims.h"
#include "claims/tally.h"

namespace podm::verify {

namespace {

// A distance is accepted if it is within this number of voxels, or within this number of mm.
struct Bound {
  double voxels, mm;

  bool admits(double distance_mm, double distance_voxels) const {
    return distance_voxels <= voxels || distance_mm <= mm;
  }
};

struct OneWay {
  Distances all;
  std::map<LabelValue, Distances> of_label;
  Distances vertices;               // mesh to image only
  std::vector<GlobalId> bad_cells;  // cells of facets with a sample beyond the bound of statement 2
  std::uint64_t far_facets = 0, samples = 0;
  WorstWitnesses worst;

  void add(const OneWay& other) {
    all.add(other.all);
    for (const auto& [label, distances] : other.of_label) of_label[label].add(distances);
    vertices.add(other.vertices);
    bad_cells.insert(bad_cells.end(), other.bad_cells.begin(), other.bad_cells.end());
    far_facets += other.far_facets;
    samples += other.samples;
    worst.add(other.worst);
  }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(all, of_label, vertices, far_facets, samples, worst);
  }
};

class Comparison {
 public:
  Comparison(const Mesh& mesh, const Adjacency& adjacency, const Image& image, Space space, int threads)
      : threads_(threads),
        mesh_(mesh),
        image_(image),
        frame_(image, space),
        facets_(mesh, adjacency, frame_, threads),
        midpoints_(image, frame_, LabelFunction(image)),
        isosurface_(image, frame_, midpoints_, LabelFunction(image)),
        nearest_facets_(mesh, facets_) {
    for (std::size_t axis = 0; axis < 3; ++axis) face_area_[axis] = area_of_face(image, axis);
  }

  // The functions are collective; each returns what all ranks find.
  bool has_both() const {
    return sum_over(ranks_of(mesh_), facets_.all().size()) > 0 && !midpoints_.all().empty();
  }

  OneWay mesh_to_image(const Bound& largest) const {
    return over_ranks(mesh_, sum_over_ranges(facets_.all().size(), threads_, OneWay{},
                                             [&](std::size_t begin, std::size_t end, OneWay& way) {
                                               std::uint32_t hint = kNone;
                                               for (std::size_t f = begin; f < end; ++f)
                                                 measure_facet(static_cast<std::uint32_t>(f), largest, hint,
                                                               way);
                                             }));
  }

  // Returns the distances from the mesh's interface to that of the image before it was smoothed.
  Distances mesh_to_voxels() const {
    const LabelFunction of_voxels = LabelFunction::of_voxels(image_);
    const Midpoints midpoints(image_, frame_, of_voxels);
    const IsosurfaceDistance isosurface(image_, frame_, midpoints, of_voxels);
    const OneWay own = sum_over_ranges(
        facets_.all().size(), threads_, OneWay{}, [&](std::size_t begin, std::size_t end, OneWay& way) {
          std::uint32_t hint = kNone;
          for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f)
            facets_.sample(f, [&](const Point& p, double share) {
              const auto answer = isosurface.nearest(p, hint);
              way.all.add(std::sqrt(answer.squared), voxels_between(p, answer.point),
                          share * facets_.area(f));
            });
        });
    return over_ranks(mesh_, own).all;
  }

  OneWay image_to_mesh() const {
    OneWay own;
    for (std::size_t begin = 0; begin < midpoints_.all().size(); begin += kMidpointsAtOnce)
      own.add(measure_midpoints(own_midpoints(begin)));
    return over_ranks(mesh_, own);
  }

 private:
  static constexpr std::size_t kMidpointsAtOnce = 1 << 18;  // the memory of queries is then small

  // Returns those of the next midpoints that this rank measures: each is nearest to the box of its facets.
  std::vector<Midpoint> own_midpoints(std::size_t begin) const {
    std::vector<Midpoint> own;
    const std::size_t end = std::min(begin + kMidpointsAtOnce, midpoints_.all().size());
    for (std::size_t m = begin; m < end; ++m)
      if (nearest_facets_.is_nearest_rank(midpoints_.all()[m].world)) own.push_back(midpoints_.all()[m]);
    return own;
  }

  // Collective.
  OneWay measure_midpoints(const std::vector<Midpoint>& own) const {
    std::vector<FacetQuery> queries;
    for (const Midpoint& midpoint : own) queries.push_back({.point = midpoint.world});
    const std::vector<NearestFacet> nearest = nearest_facets_.find(queries, threads_);
    // The nearest facet is also that of a label if the label is on one of its sides.
    std::vector<FacetQuery> queries_of_label;
    std::vector<std::size_t> place(own.size());
    for (std::size_t m = 0; m < own.size(); ++m) {
      place[m] = queries_of_label.size();
      for (const LabelValue label : own[m].labels)
        if (label != 0 && !nearest[m].has(label))
          queries_of_label.push_back({.point = own[m].world, .label = label});
    }
    const std::vector<NearestFacet> of_label = nearest_facets_.find(queries_of_label, threads_);
    return sum_over_ranges(own.size(), threads_, OneWay{},
                           [&](std::size_t begin, std::size_t end, OneWay& way) {
                             for (std::size_t m = begin; m < end; ++m)
                               measure_midpoint(own[m], nearest[m], of_label.data() + place[m], way);
                           });
  }

  static double area_of_face(const Image& image, std::size_t axis) {
    const auto& a = image.voxel_to_ras;
    const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    return std::hypot(a[4 + i] * a[8 + j] - a[8 + i] * a[4 + j], a[8 + i] * a[j] - a[i] * a[8 + j],
                      a[i] * a[4 + j] - a[4 + i] * a[j]);
  }

  double voxels_between(const Point& p, const Point& q) const {
    const Point d = frame_.world_to_voxels_vector({q[0] - p[0], q[1] - p[1], q[2] - p[2]});
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }

  void measure_facet(std::uint32_t f, const Bound& largest, std::uint32_t& hint, OneWay& way) const {
    const InterfaceFacet& facet = facets_.all()[f];
    const double area = facets_.area(f);
    const auto corners = facets_.triangle(f);
    bool is_too_far = false;
    double furthest = -1;
    Point furthest_at{};
    facets_.sample(f, [&](const Point& p, double share) {
      const auto answer = isosurface_.nearest(p, hint);
      const double mm = std::sqrt(answer.squared), voxels = voxels_between(p, answer.point);
      way.all.add(mm, voxels, share * area);
      ++way.samples;
      is_too_far = is_too_far || !largest.admits(mm, voxels);
      if (p == corners[0] || p == corners[1] || p == corners[2]) way.vertices.add(mm, voxels, 1);
      for (const LabelValue label : facet.labels)
        measure_label(p, label, answer, mm, voxels, share * area, way);
      if (voxels <= furthest) return;
      furthest = voxels;
      furthest_at = p;
    });
    way.far_facets += is_too_far ? 1 : 0;
    if (is_too_far) way.bad_cells.push_back(global_cell(mesh_, facet.cell));
    if (!way.worst.wants(furthest)) return;
    Witness witness;
    witness.statement = "the mesh's interface lies within sqrt(3) times the bound of the image's";
    witness.cells = {global_cell(mesh_, facet.cell)};
    witness.vertices = global_vertices(mesh_, facet.vertices);
    witness.points = {frame_.voxels_to_mesh(frame_.world_to_voxels(furthest_at))};
    witness.value = witness.severity = furthest;
    witness.label = facet.labels[0];
    way.worst.add(witness);
  }

  // The nearest point of any interface is also nearest for the label if the label ends there.
  void measure_label(const Point& p, LabelValue label, const IsosurfaceDistance::Answer& of_any, double mm,
                     double voxels, double weight, OneWay& way) const {
    if (label <= 0 || label > std::numeric_limits<std::uint32_t>::max()) return;
    const auto value = static_cast<std::uint32_t>(label);
    if (!of_any.bounds(value)) {
      const auto answer = isosurface_.nearest_of_label(p, value);
      if (std::isinf(answer.squared)) return;
      mm = std::sqrt(answer.squared);
      voxels = voxels_between(p, answer.point);
    }
    way.of_label[label].add(mm, voxels, weight);
  }

  // `of_label` are the nearest facets of the midpoint's labels that the nearest facet does not have.
  void measure_midpoint(const Midpoint& midpoint, const NearestFacet& nearest, const NearestFacet* of_label,
                        OneWay& way) const {
    const double weight = face_area_[midpoint.axis];
    const double voxels = voxels_between(midpoint.world, nearest.point);
    way.all.add(std::sqrt(nearest.squared), voxels, weight);
    ++way.samples;
    for (const LabelValue label : midpoint.labels) {
      if (label == 0) continue;
      const NearestFacet& facet = nearest.has(label) ? nearest : *of_label++;
      if (std::isinf(facet.squared)) continue;
      way.of_label[label].add(std::sqrt(facet.squared), voxels_between(midpoint.world, facet.point), weight);
    }
    if (voxels < way.worst.least_kept()) return;  // among equals the first points, on whatever rank
    Witness witness;
    witness.statement = "the image's interface lies near the mesh's (its maximum is not judged)";
    witness.points = {frame_.voxels_to_mesh(frame_.world_to_voxels(midpoint.world))};
    witness.value = witness.severity = voxels;
    witness.label = std::max(midpoint.labels[0], midpoint.labels[1]);
    way.worst.add(witness);
  }

  int threads_;
  const Mesh& mesh_;
  const Image& image_;
  ImageFrame frame_;
  InterfaceFacets facets_;
  Midpoints midpoints_;
  IsosurfaceDistance isosurface_;
  NearestFacets nearest_facets_;
  std::array<double, 3> face_area_{};  // mm^2, by axis
};

nlohmann::json labels_table(const Mesh& mesh, const OneWay& to_image, const OneWay& to_mesh) {
  std::set<LabelValue> labels;
  for (const auto& [label, distances] : to_image.of_label) labels.insert(label);
  for (const auto& [label, distances] : to_mesh.of_label) labels.insert(label);
  auto table = nlohmann::json::array();
  const auto json_of = [](const OneWay& way, LabelValue label) -> nlohmann::json {
    const auto found = way.of_label.find(label);
    return found == way.of_label.end() ? nlohmann::json() : found->second.to_json();
  };
  for (const LabelValue label : labels) {
    const auto name = mesh.label_names.find(label);
    table.push_back({{"label", label},
                     {"name", name == mesh.label_names.end() ? "" : name->second},
                     {"mesh_to_image", json_of(to_image, label)},
                     {"image_to_mesh", json_of(to_mesh, label)}});
  }
  return table;
}

}  // namespace

ClaimResult check_fidelity(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                           const Options& options) {
  ClaimResult result;
  result.claim = "fidelity";
  result.method =
      "sampled distances; nearest facet by a tree of boxes, nearest isosurface point by bisection";
  result.reason = lack_of_cell_labels(mesh);
  if (!result.reason.empty()) return result;
  const Space space = options.space.value_or(mesh.space);
  const Comparison comparison(mesh, adjacency, image, space, num_threads(options.threads));
  if (!comparison.has_both()) {
    result.reason = "the mesh or the image has no interface between labels";
    return result;
  }
  const double diagonal = std::sqrt(3.0), delta = options.delta_mm.value_or(0);
  const Bound bound{options.fidelity_bound_voxels, 2 * delta / diagonal};
  const Bound largest{diagonal * bound.voxels, 2 * delta};
  const OneWay to_image = comparison.mesh_to_image(largest), to_mesh = comparison.image_to_mesh();
  const auto is_near = [&](const Distances& distances) {
    return bound.admits(distances.mm.percentile(0.95), distances.voxels.percentile(0.95));
  };
  result.num_checked = to_image.samples + to_mesh.samples;
  result.num_violations =
      to_image.far_facets + (is_near(to_image.all) ? 0 : 1) + (is_near(to_mesh.all) ? 0 : 1);
  result.bad_cells = to_image.bad_cells;
  if (result.num_violations == 0 || to_image.far_facets > 0) result.worst = to_image.worst.worst_first();
  result.details() = {{"space", describe(space)},
                      {"bound_voxels", bound.voxels},
                      {"bound_mm", bound.mm},
                      {"mesh_to_image", to_image.all.to_json()},
                      {"image_to_mesh", to_mesh.all.to_json()},
                      {"interface_vertices_to_image", to_image.vertices.to_json()},
                      {"facets_too_far", to_image.far_facets},
                      {"labels", labels_table(mesh, to_image, to_mesh)}};
  auto& furthest = result.details()["furthest_from_mesh"] = nlohmann::json::array();
  for (const Witness& witness : to_mesh.worst.worst_first())
    furthest.push_back({{"point", witness.points[0]}, {"label", witness.label}, {"voxels", witness.value}});
  const auto text_of = [](const Distances& distances) {
    return fmt::format("mean {:.3f}, 95 % {:.3f}, max {:.3f} voxels ({:.3f} mm)", distances.voxels.mean(),
                       distances.voxels.percentile(0.95), distances.voxels.maximum(), distances.mm.maximum());
  };
  result.reason =
      fmt::format("mesh to image: {}; image to mesh: {}", text_of(to_image.all), text_of(to_mesh.all));
  if (image.smoothing) {
    const Distances to_voxels = comparison.mesh_to_voxels();
    result.details()["mesh_to_voxels"] = to_voxels.to_json();
    result.reason += fmt::format("; mesh to the image before it was smoothed: {}", text_of(to_voxels));
  }
  result.verdict = verdict_on(result.num_violations);
  return result;
}

}  // namespace podm::verify
