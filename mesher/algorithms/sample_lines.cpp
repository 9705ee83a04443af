#include "algorithms/sample_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <new>
#include <utility>

#include "algorithms/podm.h"
#include "algorithms/sampler.h"
#include "delaunay/walk.h"
#include "podm/errors.h"
#include "podm/option.h"
#include "refine/line_survey.h"

namespace podm {

namespace {

constexpr const char* kLines = "lines";
// Floor of edges over the least distance of samples. The lines' delta is at least this part of the spacing of
// other vertices: samples at half of it are still accepted (Worker::kSpacingFloor).
constexpr double kFloor = 0.25;
// Greatest distance of an arc from its edges, over the lines' delta.
constexpr double kMostDeviation = 0.25;
constexpr std::size_t kLeastOfLoop = 3;  // edges
// Samples in a flat box are moved along their arc by up to this share of the distance between them.
constexpr double kIrregular = 0.02;

// Samples of lines that are straight and parallel would lie on circles. The flat cells between them may have
// any shape after the mesh of an oblique image is turned.
double irregular(std::size_t arc, std::size_t sample) {
  return kIrregular *
         std::fabs(std::sin(13.0 * static_cast<double>(sample) + 78.2 * static_cast<double>(arc)));
}

class LineSampler : Sampler {
 public:
  LineSampler(Construction& construction, const Parameters& parameters)
      : Sampler(construction, parameters, kLines),
        rules_(construction.mesh(), construction.problem().isosurface, parameters),
        edges_(*parameters.lines),
        lines_(edges_.lines()) {}

  void sample();
  /// Splits edges until none is left to split, or the run is over. Returns the number of splits.
  std::uint64_t split_all();
  /// Vertices without an edge in the mesh that has three labels around it count as other vertices of the
  /// isosurface from now on. Returns their number.
  std::uint64_t give_up_lost();
  /// The cells to which rules may apply: those that insertions made, and those around lost vertices.
  Construction::Entries take_changed() { return std::exchange(changed_, {}); }

 private:
  VertexId insert(const LinePoint& at);
  void sample(std::size_t arc);
  void list_poor();
  void list_beside(VertexId inserted);
  bool leaves_arc(const LineEdge& edge) const {
    return lines_.arc(edge.arc).chord_deviation(edge.from, edge.to) > kMostDeviation * edges_.delta_mm();
  }
  bool is_current(const LineEdge& edge) const;
  bool is_to_be_split(const LineEdge& edge);
  bool split(const LineEdge& edge);
  void find_ball(VertexId v);
  void note_changed(const std::vector<CellId>& cells) {
    for (const CellId c : cells) changed_.push_back({c, mesh_.stamp(c)});
  }

  const Rules rules_;
  LineEdges& edges_;
  const Lines& lines_;
  std::deque<LineEdge> listed_;
  Construction::Entries changed_;
  std::vector<CellId> ball_;  // scratch
};

// Where the exact point is not found, the vertex is at least on the isosurface.
VertexId LineSampler::insert(const LinePoint& at) {
  std::optional<SurfacePoint> p = at.point;
  if (!at.is_exact) p = rules_.settled_on_sides(at.point, edges_.delta_mm());
  const VertexId v = p ? worker_.insert_on_line(*p, living_cell(mesh_, last_)) : kNoVertex;
  if (v == kNoVertex) return v;
  last_ = worker_.created().front();
  note_changed(worker_.created());
  return v;
}

void LineSampler::sample() {
  const LineNetwork& network = lines_.network();
  for (std::size_t node = 0; node < network.nodes.size() && !is_over(); ++node) {
    const std::optional<SurfacePoint> exact = lines_.exact_node(node);
    VertexId v = exact ? insert({*exact, 0, true}) : kNoVertex;
    const bool is_exact = v != kNoVertex;
    if (!is_exact) v = insert({lines_.node(node), 0, false});  // two may be one exact point
    if (v == kNoVertex) continue;
    edges_.set_node(node, v);
    edges_.num_inexact += !is_exact;
  }
  for (std::size_t arc = 0; arc < lines_.num_arcs() && !is_over(); ++arc) sample(arc);
}

void LineSampler::sample(std::size_t arc) {
  const LineArc& of = lines_.network().arcs[arc];
  const auto has_vertex = [&](std::int32_t node) {
    return edges_.vertex_of_node(static_cast<std::size_t>(node)) != kNoVertex;
  };
  if (!of.is_closed() && !(has_vertex(of.first_node) && has_vertex(of.last_node))) return;
  const double length = lines_.arc(arc).length();
  const bool is_loop = of.first_node == of.last_node;
  const double most_mm = (lines_.is_box_flat() ? 1 - kIrregular : 1) * edges_.delta_mm();
  const auto count = std::max(static_cast<std::size_t>(std::ceil(length / most_mm)),
                              is_loop ? kLeastOfLoop : std::size_t{1});
  if (is_loop && length < static_cast<double>(count) * edges_.floor_mm()) return;
  std::vector<LineEdges::Sample> inner;
  for (std::size_t i = of.is_closed() ? 0 : 1; i < count && !is_over(); ++i) {
    const double moved = static_cast<double>(i) + (lines_.is_box_flat() ? irregular(arc, i) : 0);
    const double position = length * moved / static_cast<double>(count);
    const LinePoint at = edges_.point_at(arc, position);
    const VertexId v = insert(at);
    if (v == kNoVertex) continue;
    inner.push_back({v, position});
    edges_.num_inexact += !at.is_exact;
  }
  const std::size_t least = of.is_closed() ? kLeastOfLoop : is_loop ? kLeastOfLoop - 1 : 0;
  if (inner.size() >= least && !stop_.is_over()) return edges_.join(arc, inner);
  for (const LineEdges::Sample& sample : inner) mesh_.vertex(sample.vertex).kind = VertexKind::kPinned;
}

// A later split may have replaced a listed edge.
bool LineSampler::is_current(const LineEdge& edge) const {
  bool is_found = false;
  edges_.for_each_edge_of(edge.first, [&](const LineEdge& of) { is_found = is_found || of.is_same(edge); });
  return is_found;
}

// Leaves the cells around v in ball_.
void LineSampler::find_ball(VertexId v) {
  last_ = cell_with(mesh_, mesh_.point(v), living_cell(mesh_, last_));
  find_around_vertex(mesh_, v, last_, ball_);
}

// An edge is in the mesh if one of the cells around its first vertex has it.
bool LineSampler::is_to_be_split(const LineEdge& edge) {
  if (!edges_.may_be_split(edge)) return false;
  if (leaves_arc(edge)) return true;
  find_ball(edge.first);
  const Point &a = mesh_.point(edge.first), &b = mesh_.point(edge.last);
  bool is_in_mesh = false;
  for (const CellId c : ball_) {
    if (!mesh_.cell(c).has(edge.last)) continue;
    is_in_mesh = true;
    for (const VertexId v : mesh_.cell(c).vertices)
      if (v != edge.first && v != edge.last && is_in_diametral_ball(mesh_.point(v), a, b)) return true;
  }
  return !is_in_mesh;
}

std::uint64_t LineSampler::give_up_lost() {
  std::vector<bool> has_edge(mesh_.vertex_bound());
  const LineSurvey survey(mesh_, edges_, [&](CellId c) { return rules_.label_of(c); });
  for (std::size_t arc = 0; arc < lines_.num_arcs(); ++arc)
    edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      if (survey.around(edge).labels.size() >= 3) has_edge[edge.first] = has_edge[edge.last] = true;
    });
  std::uint64_t count = 0;
  for (VertexId v = 0; v < mesh_.vertex_bound(); ++v) {
    if (has_edge[v] || mesh_.vertex(v).kind != VertexKind::kLine) continue;
    mesh_.vertex(v).kind = VertexKind::kPinned;
    find_ball(v);
    for (const CellId c : ball_) mesh_.forget_facets_passing_r3(c);  // R3 is another one here now
    note_changed(ball_);
    ++count;
  }
  return count;
}

// Lists the edges that may have to be split. Labels are not needed.
void LineSampler::list_poor() {
  const LineSurvey survey(mesh_, edges_, [](CellId) { return kUnknownLabel; });
  for (std::size_t arc = 0; arc < lines_.num_arcs(); ++arc)
    edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      const LineSurvey::Around& around = survey.around(edge);
      if (around.labels.empty() || around.has_vertex_in_ball || leaves_arc(edge)) listed_.push_back(edge);
    });
}

// Lists the edges that a new vertex on a line makes, and those with the vertex in their balls: both ends of
// these are vertices of its cells (line_keeper.h), unless they are listed already or cannot be split. All
// other edges stay in the mesh, with no vertex in their balls.
void LineSampler::list_beside(VertexId inserted) {
  std::vector<VertexId> vertices;
  for (const CellId c : worker_.created())
    for (const VertexId v : mesh_.cell(c).vertices)
      if (mesh_.vertex(v).kind == VertexKind::kLine) vertices.push_back(v);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  edges_.for_each_edge_of(inserted, [&](const LineEdge& edge) { listed_.push_back(edge); });
  const Point& p = mesh_.point(inserted);
  for (const VertexId v : vertices)
    edges_.for_each_edge_of(v, [&](const LineEdge& edge) {
      if (edge.first == v && v != inserted && edge.last != inserted &&
          is_in_diametral_ball(p, mesh_.point(v), mesh_.point(edge.last)))
        listed_.push_back(edge);
    });
}

bool LineSampler::split(const LineEdge& edge) {
  const LinePoint at = edges_.split_point(edge);
  const VertexId v = insert(at);
  if (v == kNoVertex) return false;
  edges_.split(edge, v, at);
  list_beside(v);
  return true;
}

std::uint64_t LineSampler::split_all() {
  std::uint64_t count = 0;
  list_poor();
  for (; !listed_.empty() && !is_over(); listed_.pop_front()) {
    const LineEdge edge = listed_.front();
    if (is_current(edge) && is_to_be_split(edge)) count += split(edge);
  }
  return count;
}

// Throws InputError on a lines' delta that leaves no room for samples.
void check_delta(const Problem& problem, const Parameters& parameters) {
  const double least_mm = kFloor * parameters.spacing_mm;
  if (problem.lines_delta_mm < least_mm)
    throw InputError(fmt::format("{}: {:g} mm is below {:.4g} mm, a quarter of the spacing of other vertices",
                                 spelled("lines-delta"), problem.lines_delta_mm, least_mm));
}

}  // namespace

void sample_lines(Construction& construction, Parameters& parameters) try {
  const Problem& problem = construction.problem();
  if (problem.lines == nullptr) return;
  construction.timed(kLines, [&] {
    check_delta(problem, parameters);
    const double floor_mm = kFloor * std::min(parameters.spacing_mm, problem.lines_delta_mm);
    construction.keep_lines(std::make_unique<LineEdges>(*problem.lines, problem.lines_delta_mm, floor_mm,
                                                        construction.mesh().vertex_capacity()));
    parameters.lines = construction.line_edges();
    LineSampler sampler(construction, parameters);
    sampler.sample();
    sampler.split_all();
  });
} catch (const std::bad_alloc&) {
  construction.stop().end(StopReason::kMemoryLimit);
}

void mend_lines(Construction& construction, const Parameters& parameters) try {
  if (parameters.lines == nullptr) return;
  std::uint64_t num_changes = 1;
  while (num_changes > 0 && !construction.stop().is_over()) {
    Construction::Entries changed;
    construction.timed(kLines, [&] {
      LineSampler sampler(construction, parameters);
      num_changes = sampler.split_all() + sampler.give_up_lost();
      changed = sampler.take_changed();
    });
    if (num_changes > 0)
      refine_anywhere(construction, kLines, parameters, changed, construction.num_workers());
  }
} catch (const std::bad_alloc&) {
  construction.stop().end(StopReason::kMemoryLimit);
}

}  // namespace podm
