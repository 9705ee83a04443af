#include "run/extract_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_set>

#include "image/working_frame.h"
#include "io/lines_of_facets.h"
#include "refine/line_survey.h"

namespace podm {

namespace {

// The first two exclude a stretch: the mesh has no room for its edges.
constexpr const char *kBesideOther = "too near another line", *kTooSmall = "too small to be sampled",
                     *kNoEdge = "no edge of the mesh";

EdgeKey key_of(const LineEdge& edge) { return edge_key(edge.first, edge.last); }

// The vertices on lines, by cubes. A cube's side is at least the length of any edge, so a ball around an edge
// meets at most eight cubes.
class VerticesOnLines {
 public:
  VerticesOnLines(const Mesh& mesh, const LineEdges& edges) : mesh_(mesh) {
    const std::size_t num_arcs = edges.lines().network().arcs.size();
    for (std::size_t arc = 0; arc < num_arcs; ++arc)
      edges.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
        side_ = std::max(side_, distance(mesh.point(edge.first), mesh.point(edge.last)));
      });
    for (std::size_t arc = 0; arc < num_arcs; ++arc)
      edges.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
        for (const VertexId v : {edge.first, edge.last})
          vertices_.push_back({cube_of(mesh.point(v)), v, edge.arc});
      });
    std::ranges::sort(vertices_);
    const auto repeated = std::ranges::unique(vertices_);
    vertices_.erase(repeated.begin(), repeated.end());
  }

  /// Returns true if a vertex of another arc is in the ball of the edge.
  bool has_another_in_ball_of(const LineEdge& edge) const {
    const Point &a = mesh_.point(edge.first), &b = mesh_.point(edge.last);
    const Point middle = a + 0.5 * (b - a);
    const double radius = distance(a, b) / 2;
    const Cube low = cube_of(middle - Vector{radius, radius, radius}),
               high = cube_of(middle + Vector{radius, radius, radius});
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k)
          if (has_another_in_ball_and_cube(edge, {i, j, k})) return true;
    return false;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  struct Entry {
    Cube cube;
    VertexId vertex;
    std::uint32_t arc;
    auto operator<=>(const Entry&) const = default;
  };

  Cube cube_of(const Point& p) const {
    const auto number = [&](double x) { return static_cast<std::int64_t>(std::floor(x / side_)); };
    return {number(p.x), number(p.y), number(p.z)};
  }
  bool has_another_in_ball_and_cube(const LineEdge& edge, const Cube& cube) const {
    const Point &a = mesh_.point(edge.first), &b = mesh_.point(edge.last);
    return std::ranges::any_of(
        std::ranges::equal_range(vertices_, cube, {}, &Entry::cube), [&](const Entry& other) {
          return other.arc != edge.arc && is_in_diametral_ball(mesh_.point(other.vertex), a, b);
        });
  }

  const Mesh& mesh_;
  double side_ = std::numeric_limits<double>::min();
  std::vector<Entry> vertices_;
};

class LineExtractor {
 public:
  LineExtractor(const Mesh& mesh, const LineEdges& edges, const LabelImage& image, LinesReport& report)
      : mesh_(mesh),
        edges_(edges),
        network_(edges.lines().network()),
        image_(image),
        report_(report),
        vertices_(mesh, edges),
        survey_(mesh, edges, [&](CellId c) { return mesh.label(c); }) {}

  MeshLines operator()() {
    report_.delta_mm = out_.delta_mm = edges_.delta_mm();
    report_.floor_mm = edges_.floor_mm();
    report_.is_traced = network_.is_whole;
    report_.arcs = network_.arcs.size();
    report_.nodes = network_.nodes.size();
    report_.splits = edges_.num_splits;
    report_.inexact_vertices = edges_.num_inexact;
    for (std::size_t arc = 0; arc < network_.arcs.size(); ++arc) add(arc);
    report_.edges = out_.edges.size();
    report_.untraced_mm = untraced_mm();
    for (const UndecidedPlace& place : network_.undecided) add(place);
    return std::move(out_);
  }

 private:
  const char* why_left_out(const LineEdge& edge) const;
  void add(std::size_t arc);
  void keep(const LineEdge& edge);
  void add(const UndecidedPlace& place);
  std::uint32_t line_of(const LabelSet& labels);
  std::array<double, 3> ras(const Point& p) const {
    const Point world = map(working_to_world(image_), p);
    return {world.x, world.y, world.z};
  }
  double untraced_mm() const;
  void leave_out(std::size_t arc, double from, double length_mm, const char* reason);

  const Mesh& mesh_;
  const LineEdges& edges_;
  const LineNetwork& network_;
  const LabelImage& image_;
  LinesReport& report_;
  VerticesOnLines vertices_;
  LineSurvey survey_;
  std::unordered_set<EdgeKey> kept_;
  std::map<LabelSet, std::uint32_t> lines_;
  MeshLines out_;
};

// Null if the edge is kept. Two arcs may join the same vertices: the edge then has the labels of both, or it
// is the first one's.
const char* LineExtractor::why_left_out(const LineEdge& edge) const {
  if (std::ranges::includes(survey_.around(edge).labels, network_.arcs[edge.arc].labels)) return nullptr;
  if (kept_.contains(key_of(edge))) return kBesideOther;
  return vertices_.has_another_in_ball_of(edge) ? kBesideOther : kNoEdge;
}

std::uint32_t LineExtractor::line_of(const LabelSet& labels) {
  const auto [found, is_new] = lines_.emplace(labels, static_cast<std::uint32_t>(lines_.size()));
  if (is_new) out_.labels_of_line.push_back(labels);
  return found->second;
}

void LineExtractor::leave_out(std::size_t arc, double from, double length_mm, const char* reason) {
  LinesReport::LeftOut left_out{reason, {}, length_mm, {}};
  for (const LabelIndex label : network_.arcs[arc].labels) left_out.labels.push_back(image_.labels[label]);
  left_out.ras_mm = ras(edges_.lines().arc(arc).point_at(from + length_mm / 2));
  if (reason == kBesideOther || reason == kTooSmall) report_.excluded_mm += length_mm;
  report_.left_out.push_back(std::move(left_out));
}

void LineExtractor::add(std::size_t arc) {
  const double length_mm = edges_.lines().arc(arc).length();
  report_.traced_mm += length_mm;
  bool has_edge = false;
  edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
    has_edge = true;
    if (const char* reason = why_left_out(edge))
      leave_out(arc, edge.from, edges_.length(edge), reason);
    else
      keep(edge);
  });
  if (!has_edge) leave_out(arc, 0, length_mm, kTooSmall);
}

// The labels around the edge name its line: others may meet there beside those of the arc. Each edge is
// listed once.
void LineExtractor::keep(const LineEdge& edge) {
  report_.kept_mm += edges_.length(edge);
  if (!kept_.insert(key_of(edge)).second) return;
  out_.edges.push_back({edge.first, edge.last});
  out_.line_of_edge.push_back(line_of(survey_.around(edge).labels));
}

// An undecided place may hide a curve of a voxel. The lengths of curves that are too small are known.
double LineExtractor::untraced_mm() const {
  const auto num_unknown = std::ranges::count_if(network_.undecided, [](const UndecidedPlace& place) {
    return place.reason != UndecidedPlace::Reason::kTooSmall;
  });
  return (static_cast<double>(num_unknown) + network_.removed_voxels) * std::ranges::max(image_.spacing);
}

void LineExtractor::add(const UndecidedPlace& place) {
  static constexpr std::array kReasons{"missed", "unconfirmed", "too small"};
  report_.undecided.push_back({kReasons[static_cast<std::size_t>(place.reason)],
                               {place.block.i, place.block.j, place.block.k},
                               ras(place.point)});
}

}  // namespace

MeshLines extract_lines(const Mesh& mesh, const LineEdges& edges, const LabelImage& image,
                        LinesReport& report) {
  return LineExtractor(mesh, edges, image, report)();
}

std::vector<std::array<std::uint32_t, 2>> stray_edges(const TetMesh& mesh) {
  std::unordered_set<EdgeKey> kept;
  for (const auto& [u, v] : mesh.lines.edges) kept.insert(edge_key(u, v));
  std::vector<std::array<std::uint32_t, 2>> edges = lines_of_facets(mesh, mesh.lines.delta_mm).edges;
  std::erase_if(edges, [&](const auto& edge) { return kept.contains(edge_key(edge[0], edge[1])); });
  return edges;
}

}  // namespace podm
