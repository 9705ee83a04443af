// Claim surface_vertices.
//   Statements  First, each vertex of a facet between cells of different labels, or of a facet with one cell,
//               lies where the label function (image/label_function.h) changes: within b voxels of it there
//               are two points of different labels. For a smoothed image (image/smoothing.h) the function is
//               the smoothed one. Second, if delta is given (--delta), each label of the vertex's facets,
//               background beyond the outermost ones, has a voxel within reach of the vertex. The reach is a
//               voxel's diagonal plus the longer of 2 delta and another diagonal.
//               b is 10^-5 (Options::vertex_bound_voxels), a distance in voxel indices. A mesh of the PODM
//               family has its vertices on the isosurface to 10^-6, by the search that finds them; the rest
//               allows for the rounding of coordinates on their way to the file. The reach follows from the
//               mesher's rules. The circumcenter of a facet's cell has the cell's label. R2 left no cell of
//               the surface a circumradius of 2 delta. One of the eight voxels around a point has the label
//               of that point.
//   Rests on    Two witnesses for each vertex: the vertex itself, rounded to a point p of double voxel
//               indices, and a point of another label than p's, which a search finds (label_search.h).
//               Filters and then rational arithmetic decide that both are within b of the vertex of the file,
//               and that their labels differ. The search may miss a point, so the claim may fail for a mesh
//               for which it holds; it never passes if it does not hold. Voxel weights of a smoothed image
//               are taken to be right: smoothing.cpp computes them and is tested against its definition.
//               Distances of the second statement are rounded.
//   Cost        Linear in the vertices of the surface; 2 to 20 us for each, more if more labels meet near it,
//               and 40 bytes per facet side.
//   Not proved  That a vertex lies between the labels of its own facets. Where three labels meet, a facet
//               that passes from one label to a second may have a vertex where the first ends at a third.
//               Such vertices are counted ("vertices_off_own_labels"), not judged. Nor that a vertex of a
//               line lies where all labels of the line meet, which the claim lines judges by a bound of its
//               own. Nor that a facet is near the isosurface between its vertices, which the claim fidelity
//               samples. The first statement is the promise of meshers of the PODM family; a mesh of another
//               mesher need not keep it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "claims/check_labels_reach.h"
#include "claims/check_surface_boundary.h"
#include "claims/claims.h"
#include "claims/label_search.h"
#include "claims/tally.h"
#include "claims/voxel_map.h"

namespace podm::verify {

namespace {

// Less than 1 by more than the rounding of a vertex's voxel indices.
constexpr double kSearchRadiusFactor = 1 - 1e-3;
constexpr std::array<double, 2> kFurtherVoxels{0.01, 1};  // search radii around a vertex in violation

double diagonal_mm(const Image& image) {
  return std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
}

struct VertexTally : Tally {
  std::uint64_t num_vertices = 0, num_off_own_labels = 0;
  double furthest_voxels = 0;

  void add(const VertexTally& other) {
    Tally::add(other);
    num_vertices += other.num_vertices;
    num_off_own_labels += other.num_off_own_labels;
    furthest_voxels = std::max(furthest_voxels, other.furthest_voxels);
  }
  template <class Stream>
  void transfer(Stream& stream) {
    Tally::transfer(stream);
    stream(num_vertices, num_off_own_labels, furthest_voxels);
  }
};

class SurfaceVertices {
 public:
  SurfaceVertices(const Mesh& mesh, const Adjacency& adjacency, const Image& image, const Options& options,
                  Space space, int threads)
      : mesh_(mesh),
        label_indices_(mesh),
        sides_(find_sides(mesh, adjacency, label_indices_, threads)),
        sides_of_(sides_, mesh.vertices.size()),
        frame_(image, space),
        to_voxels_(image.voxel_to_ras, space),
        search_(image),
        judges_reach_(options.delta_mm.has_value()),
        reach_(image, std::max(2 * options.delta_mm.value_or(0), diagonal_mm(image))),
        bound_(options.vertex_bound_voxels),
        squared_bound_(decimal_as_typed(bound_) * decimal_as_typed(bound_)) {}

  double reach_mm() const { return reach_.mm(); }

  void check(VertexId v, VertexTally& part) const {
    const std::vector<LabelValue> labels = labels_around(v);
    if (labels.empty()) return;
    ++part.num_vertices;
    const Point u = frame_.to_voxels(mesh_.vertices[v]);
    const std::uint32_t own = search_.label_at(u, part.num_exact);
    const auto other = check_change(v, u, own, part);
    if (judges_reach_) check_reach(v, u, labels, part);
    const auto is_met = [&](LabelValue label) {
      const auto is_label = [label](std::uint32_t found) { return static_cast<LabelValue>(found) == label; };
      return is_label(own) || (other && is_label(other->label)) || find(u, is_label, part);
    };
    part.num_off_own_labels += std::all_of(labels.begin(), labels.end(), is_met) ? 0 : 1;
  }

 private:
  std::optional<LabelSearch::Found> find(const Point& u, const LabelSearch::Wanted& wanted,
                                         Tally& tally) const {
    return search_.find(u, wanted, kSearchRadiusFactor * bound_, tally.num_exact);
  }

  // Returns the labels of the facets that have the vertex, each once; none for a vertex off the surface.
  std::vector<LabelValue> labels_around(VertexId v) const {
    std::vector<LabelValue> labels;
    for (const std::uint32_t* side = sides_of_.begin(v); side != sides_of_.end(v); ++side)
      for (const LabelIndex index : {sides_[*side].label, sides_[*side].across})
        labels.push_back(label_indices_.labels[index]);
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return labels;
  }

  // Returns the point of another label than u's, `own`, near u.
  std::optional<LabelSearch::Found> check_change(VertexId v, const Point& u, std::uint32_t own,
                                                 VertexTally& tally) const {
    ++tally.num_checked;
    const auto is_other = [own](std::uint32_t label) { return label != own; };
    const auto near = find(u, is_other, tally);
    const bool holds =
        near && is_within_bound(v, u, tally.num_exact) && is_within_bound(v, near->at, tally.num_exact);
    auto other = near;
    for (std::size_t i = 0; !other && i < kFurtherVoxels.size(); ++i)
      other = search_.find(u, is_other, kFurtherVoxels[i], tally.num_exact);
    const double distance = other ? other->distance : std::numeric_limits<double>::infinity();
    tally.furthest_voxels = std::max(tally.furthest_voxels, distance);
    if (holds && !tally.closest.wants(distance)) return near;
    Witness witness = witness_of(v, "the image's label changes at the vertex", distance);
    if (other) witness.points.push_back(frame_.voxels_to_mesh(other->at));
    witness.label = own;
    holds ? tally.closest.add(std::move(witness)) : tally.violation(std::move(witness));
    return near;
  }

  void check_reach(VertexId v, const Point& u, const std::vector<LabelValue>& labels, Tally& tally) const {
    for (const LabelValue label : labels) {
      ++tally.num_checked;
      if (label >= 0 && label <= std::numeric_limits<std::uint32_t>::max() &&
          reach_.has(static_cast<std::uint32_t>(label), u))
        continue;
      Witness witness = witness_of(v, "a voxel of each label of the vertex's facets is within reach", 0);
      witness.severity = reach_.mm();
      witness.label = label;
      tally.violation(std::move(witness));
    }
  }

  Witness witness_of(VertexId v, const char* statement, double value) const {
    Witness witness{.statement = statement,
                    .vertices = {global_vertex(mesh_, v)},
                    .points = {mesh_.vertices[v]},
                    .value = value,
                    .severity = value};
    for (const std::uint32_t* side = sides_of_.begin(v); side != sides_of_.end(v); ++side)
      witness.cells.push_back(global_cell(mesh_, sides_[*side].cell));
    witness.cells = ascending(std::move(witness.cells));
    return witness;
  }

  // True if the vertex, as the file has it, is within the bound of p.
  bool is_within_bound(VertexId v, const Point& p, std::uint64_t& num_exact) const {
    const Point& vertex = mesh_.vertices[v];
    const auto slack = [&](auto zero) {
      using T = decltype(zero);
      const Vector<T> u = to_voxels_(Vector<T>{T(vertex[0]), T(vertex[1]), T(vertex[2])});
      const Vector<T> d{u[0] - T(p[0]), u[1] - T(p[1]), u[2] - T(p[2])};
      return T(squared_bound_.in<T>() - dot(d, d));
    };
    return sign_of(slack, num_exact) >= 0;
  }

  const Mesh& mesh_;
  CellLabelIndices label_indices_;
  std::vector<Side> sides_;
  SidesOfVertex sides_of_;
  ImageFrame frame_;
  VoxelMap to_voxels_;
  LabelSearch search_;
  bool judges_reach_;
  LabelReach reach_;
  double bound_;
  Constant squared_bound_;
};

}  // namespace

ClaimResult check_surface_vertices(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                                   const Options& options) {
  ClaimResult result;
  result.claim = "surface_vertices";
  result.reason = lack_of_cell_labels(mesh);
  if (!result.reason.empty()) return result;
  const Space space = options.space.value_or(mesh.space);
  const int threads = num_threads(options.threads);
  const SurfaceVertices vertices(mesh, adjacency, image, options, space, threads);
  const VertexTally found = over_ranks(mesh, tally_over({0, mesh.vertices.size()}, threads, VertexTally{},
                                                        [&](std::size_t v, VertexTally& tally) {
                                                          if (owns_vertex(mesh, v))
                                                            vertices.check(static_cast<VertexId>(v), tally);
                                                        }));
  result = result_of("surface_vertices", found);
  result.method = "a search for points of another label, decided by filters, then exact rationals";
  result.details() = {{"space", describe(space)},
                      {"bound_voxels", options.vertex_bound_voxels},
                      {"vertices", found.num_vertices},
                      {"furthest_voxels", found.furthest_voxels},
                      {"vertices_off_own_labels", found.num_off_own_labels}};
  if (options.delta_mm) result.details()["reach_mm"] = vertices.reach_mm();
  result.reason = fmt::format(
      "{} violations at {} vertices of boundary and interfaces; the image's label changes within {:.2g} "
      "voxels of each (bound {}); at {} a label of their facets is further off",
      result.num_violations, found.num_vertices, found.furthest_voxels, options.vertex_bound_voxels,
      found.num_off_own_labels);
  return result;
}

}  // namespace podm::verify
