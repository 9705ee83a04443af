// Claim lines.
//   Statements  Let b be half of the distance by which the mesh samples lines (--lines-delta, or as the file
//               promises). First, 99.9 % of the points where three or more labels of the image's label
//               function meet lie within b of an edge of the mesh around which three of these labels meet.
//               Second, 99.9 % of the edges around which three or more labels meet, by length, lie within b
//               of a point of the image where three of their labels meet. The background is a label, also
//               beyond the grid, and outside the sides of a flat box. An edge is therefore between the right
//               labels wherever it is near the line of others.
//   Rests on    Boxes that hold the lines of the image (lines_of_image.h), of at most 0.046 voxels. Half of
//               the diagonal of such a box is added to b. Labels that are greatest at its corners are taken
//               to meet in it; between two corners one of them may be thinner than the box. Boxes in which
//               three labels may be greatest, and are not at corners, are counted; an edge may lie near them,
//               and none must. Edges are sampled at their ends and at three points between. Distances are
//               lengths in mm in the world, rounded.
//   Cost        About 0.1 ms per block of voxels with a line, and (points + edges) log n.
//   Not proved  That the edges make up whole curves. Where a line is missing over less than 0.1 % of all
//               lines, this is reported, not judged. Edges of the image's box are the claim box's.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "claims/check_fidelity_tree.h"
#include "claims/claims.h"
#include "claims/lines_of_image.h"
#include "claims/lines_of_mesh.h"
#include "claims/tally.h"

namespace podm::verify {

namespace {

constexpr double kLeastShare = 0.999;
constexpr std::array<double, 5> kSamples{0, 0.25, 0.5, 0.75, 1};  // of an edge

using Triple = std::array<LabelValue, 3>;

template <class Labels>
std::vector<Triple> triples_of(const Labels& labels) {
  std::vector<Triple> triples;
  for (std::size_t a = 0; a < labels.size(); ++a)
    for (std::size_t b = a + 1; b < labels.size(); ++b)
      for (std::size_t c = b + 1; c < labels.size(); ++c)
        triples.push_back({static_cast<LabelValue>(labels[a]), static_cast<LabelValue>(labels[b]),
                           static_cast<LabelValue>(labels[c])});
  return triples;
}

// Finds the nearest of the shapes that have three labels in common with a place.
template <class Shapes>
class NearestOfTriple {
 public:
  /// Keeps a reference to `shapes`. labels_of(i) are the labels of shape i < count.
  template <class LabelsOf>
  NearestOfTriple(const Shapes& shapes, std::size_t count, const LabelsOf& labels_of) {
    std::map<Triple, std::vector<std::uint32_t>> ids;
    for (std::size_t i = 0; i < count; ++i)
      for (const Triple& triple : triples_of(labels_of(i)))
        ids[triple].push_back(static_cast<std::uint32_t>(i));
    for (auto& [triple, of_triple] : ids) trees_.emplace(triple, NearestTree(shapes, std::move(of_triple)));
  }

  /// Returns the distance, infinity if there is no such shape.
  template <class Labels>
  double distance(const Point& p, const Labels& labels) const {
    Nearest best;
    for (const Triple& triple : triples_of(labels))
      if (const auto tree = trees_.find(triple); tree != trees_.end()) tree->second.improve(p, best);
    return std::sqrt(best.squared);
  }

 private:
  std::map<Triple, NearestTree<Shapes>> trees_;
};

class PointShapes {
 public:
  explicit PointShapes(const std::vector<LinePoint>& points) : points_(points) {}
  Point closest(std::uint32_t i, const Point&) const { return points_[i].world; }
  void bounds(std::uint32_t i, Point& low, Point& high) const { low = high = points_[i].world; }

 private:
  const std::vector<LinePoint>& points_;
};

// `all` and `far` are numbers of points, or lengths of edges.
struct LineTally : Tally {
  double all = 0, far = 0, furthest_mm = 0;

  void add(const LineTally& other) {
    Tally::add(other);
    all += other.all;
    far += other.far;
    furthest_mm = std::max(furthest_mm, other.furthest_mm);
  }
  void look_at(double weight, double distance_mm, double bound_mm, const Witness& witness) {
    ++num_checked;
    all += weight;
    furthest_mm = std::max(furthest_mm, distance_mm);
    if (distance_mm > bound_mm) {
      far += weight;
      violation(witness);
    } else if (closest.wants(distance_mm)) {
      closest.add(witness);
    }
  }
  double share_near() const { return all > 0 ? 1 - far / all : 1; }
  nlohmann::json to_json() const {
    return {{"share_near", share_near()}, {"furthest_mm", furthest_mm}, {"far_places", num_violations}};
  }
};

class Lines {
 public:
  Lines(const Mesh& mesh, const Adjacency& adjacency, const Image& image, Space space, double bound_mm,
        int threads)
      : mesh_(mesh),
        threads_(threads),
        frame_(image, space),
        points_(lines_of_image(image, frame_, threads)),
        edges_(lines_of_mesh(mesh, adjacency, threads)),
        segments_(mesh, edges_, frame_),
        shapes_(points_),
        to_mesh_(
            segments_, edges_.size(), [&](std::size_t i) -> const auto& { return edges_[i].labels; }),
        to_image_(
            shapes_, points_.size(), [&](std::size_t i) -> const auto& { return points_[i].labels; }),
        bound_mm_(bound_mm + 0.5 * side_of_floor_voxels() *
                                 std::hypot(image.spacing[0], image.spacing[1], image.spacing[2])) {}

  const std::vector<LinePoint>& points() const { return points_; }
  std::size_t num_edges() const { return edges_.size(); }
  double length_mm() const {
    double sum = 0;
    for (std::size_t i = 0; i < edges_.size(); ++i) sum += segments_.length(i);
    return sum;
  }

  LineTally image_to_mesh() const {
    return tally_over({0, points_.size()}, threads_, LineTally{}, [&](std::size_t i, LineTally& tally) {
      const LinePoint& point = points_[i];
      if (!point.is_decided) return;
      const double distance_mm = to_mesh_.distance(point.world, point.labels);
      Witness witness{.statement = "an edge of the mesh is near the point where labels meet",
                      .points = {frame_.voxels_to_mesh(point.voxels)},
                      .value = distance_mm,
                      .severity = distance_mm};
      witness.label = point.labels.back();
      tally.look_at(1, distance_mm, bound_mm_, witness);
    });
  }

  LineTally mesh_to_image() const {
    return tally_over({0, edges_.size()}, threads_, LineTally{}, [&](std::size_t i, LineTally& tally) {
      const auto& [a, b] = segments_[i];
      double furthest_mm = 0;
      for (const double t : kSamples) {
        const Point p{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
        furthest_mm = std::max(furthest_mm, to_image_.distance(p, edges_[i].labels));
      }
      Witness witness{.statement = "the image's labels meet near the edge where those of the mesh meet",
                      .cells = {global_cell(mesh_, edges_[i].cell)},
                      .vertices = global_vertices(mesh_, edges_[i].vertices),
                      .value = furthest_mm,
                      .severity = furthest_mm};
      for (const VertexId v : edges_[i].vertices) witness.points.push_back(mesh_.vertices[v]);
      witness.label = edges_[i].labels.back();
      tally.look_at(segments_.length(i), furthest_mm, bound_mm_, witness);
    });
  }

 private:
  const Mesh& mesh_;
  int threads_;
  ImageFrame frame_;
  std::vector<LinePoint> points_;
  std::vector<LineEdge> edges_;
  LineSegments segments_;
  PointShapes shapes_;
  NearestOfTriple<LineSegments> to_mesh_;
  NearestOfTriple<PointShapes> to_image_;
  double bound_mm_;
};

// A share that is large enough excuses the places that are far.
void excuse(LineTally& way) {
  if (way.share_near() < kLeastShare) return;
  way.num_violations = 0;
  way.bad_cells.clear();
}

}  // namespace

ClaimResult check_lines(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                        const Options& options) {
  ClaimResult result;
  result.claim = "lines";
  const std::optional<double> delta_mm =
      options.lines_delta_mm ? options.lines_delta_mm : mesh.promised_lines_delta_mm;
  result.reason = lack_of_cell_labels(mesh);
  if (!delta_mm) result.reason = "no distance given (--lines-delta), and the file promises none";
  if (!result.reason.empty()) return result;
  const Space space = options.space.value_or(mesh.space);
  const Lines lines(mesh, adjacency, image, space, *delta_mm / 2, num_threads(options.threads));
  LineTally to_mesh = lines.image_to_mesh(), to_image = lines.mesh_to_image();
  const nlohmann::json of_points = to_mesh.to_json(), of_edges = to_image.to_json();
  const auto num_undecided = std::count_if(lines.points().begin(), lines.points().end(),
                                           [](const LinePoint& point) { return !point.is_decided; });
  const std::string text = fmt::format(
      "{} line edges, {:.6g} mm; {:.4f} % of the points where the image's labels meet are within {:.3g} mm "
      "of "
      "them, the furthest {:.3g}; {:.4f} % of the edges are near such points, the furthest {:.3g} mm",
      lines.num_edges(), lines.length_mm(), 100 * to_mesh.share_near(), *delta_mm / 2, to_mesh.furthest_mm,
      100 * to_image.share_near(), to_image.furthest_mm);
  excuse(to_mesh);
  excuse(to_image);
  to_mesh.add(to_image);
  result = result_of("lines", to_mesh);
  result.method = "boxes that hold the image's lines; distances rounded";
  result.reason = text;
  result.details() = {{"space", describe(space)},
                      {"lines_delta_mm", *delta_mm},
                      {"line_edges", lines.num_edges()},
                      {"length_mm", lines.length_mm()},
                      {"image_points", lines.points().size()},
                      {"undecided_points", num_undecided},
                      {"image_to_mesh", of_points},
                      {"mesh_to_image", of_edges}};
  return result;
}

}  // namespace podm::verify
