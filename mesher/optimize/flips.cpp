#include "optimize/flips.h"

#include <algorithm>

namespace podm {

namespace {

unsigned index_of(const Cell& cell, VertexId v) {
  return static_cast<unsigned>(std::find(cell.vertices.begin(), cell.vertices.end(), v) -
                               cell.vertices.begin());
}
VertexId apex_of(const Mesh& mesh, FacetId f) {
  return mesh.cell(cell_of(f)).vertices[static_cast<unsigned>(index_in_cell(f))];
}

}  // namespace

template <class Locks>
StepResult Flips<Locks>::walk_ring(const AttemptedCell& attempted, unsigned edge) {
  cavity_.clear();
  const std::array<VertexId, 4> vertices = mesh_.cell(attempted.cell).vertices;
  VertexId from = vertices[kOtherVertices[edge][0]], to = vertices[kOtherVertices[edge][1]];
  ring_.size = 0;
  CellId at = attempted.cell;
  do {
    if (ring_.size == EdgeRing::kMax || attempted.label_of(mesh_, at) != attempted.label)
      return StepResult::kOutOfReach;
    if (const StepResult added = cavity_.add(at); added != StepResult::kDone) return added;
    ring_.vertices[ring_.size++] = cavity_.local_of(from);
    const FacetId mirror = beyond(at, from);
    if (mirror == kNoFacet) return StepResult::kOutOfReach;
    from = to;
    at = cell_of(mirror);
    to = apex_of(mesh_, mirror);
  } while (at != attempted.cell);
  ring_.bottom = cavity_.local_of(vertices[static_cast<unsigned>(kEdgeVertices[edge][0])]);
  ring_.top = cavity_.local_of(vertices[static_cast<unsigned>(kEdgeVertices[edge][1])]);
  return StepResult::kDone;
}

template <class Locks>
StepResult Flips<Locks>::plan_best(const AttemptedCell& attempted) {
  best_ = {};
  for (unsigned edge = 0; edge < 6; ++edge)
    if (const StepResult planned = plan_edge(attempted, edge); planned == StepResult::kLockConflict)
      return planned;
  for (unsigned facet = 0; facet < 4; ++facet)
    if (const StepResult planned = plan_facet(attempted, facet); planned == StepResult::kLockConflict)
      return planned;
  if (best_.quality == 0) return StepResult::kNotBetter;
  // The cavity is that of the last plan. The best flip is therefore planned again, as when it was found.
  const Best best = best_;
  best_ = {};
  if (best.is_edge) {
    plan_edge(attempted, best.index);
    edge_removal_.list_cells(ring_, new_cells_);
  } else {
    plan_facet(attempted, best.index);
  }
  return StepResult::kDone;
}

template <class Locks>
StepResult Flips<Locks>::plan_edge(const AttemptedCell& attempted, unsigned edge) {
  if (const StepResult walked = walk_ring(attempted, edge); walked != StepResult::kDone) return walked;
  const double floor = std::max(best_.quality, step_over(cavity_.worst(quality_)));
  const double quality = edge_removal_.plan(cavity_.points(), ring_, attempted.bound, floor);
  if (quality > floor) best_ = {quality, true, edge};
  return StepResult::kDone;
}

// Plans the removal of the facet between the cell and another one, the inverse of edge removal, and of the
// facets beside it between the same two vertices, as far as that makes better cells (Shewchuk, "Two discrete
// optimization algorithms for the topological improvement of tetrahedral meshes", 2002).
template <class Locks>
StepResult Flips<Locks>::plan_facet(const AttemptedCell& attempted, unsigned facet) {
  const FacetId mirror = mesh_.cell(attempted.cell).mirrors[facet];
  if (mirror == kNoFacet || mesh_.label(cell_of(mirror)) != attempted.label) return StepResult::kOutOfReach;
  const CellId other = cell_of(mirror);
  cavity_.clear();
  for (const CellId c : {attempted.cell, other})
    if (const StepResult added = cavity_.add(c); added != StepResult::kDone) return added;
  const std::array<VertexId, 4> vertices = mesh_.cell(attempted.cell).vertices;
  top_ = vertices[facet];
  bottom_ = apex_of(mesh_, mirror);
  around_.clear();
  on_facets_.assign({attempted.cell, other});
  double quality = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < 3; ++i) {
    const auto at = [&](unsigned j) {
      return vertices[static_cast<unsigned>(kFacetVertices[facet][(i + j) % 3])];
    };
    double of_side = 0;
    const StepResult planned = plan_side(attempted, {attempted.cell, other, at(0), at(1), at(2), 0}, of_side);
    if (planned != StepResult::kDone) return planned;
    quality = std::min(quality, of_side);
  }
  if (quality <= best_.quality) return StepResult::kDone;
  cavity_.clear();
  for (const CellId c : on_facets_) cavity_.add(c);  // all were added before
  if (quality <= step_over(cavity_.worst(quality_))) return StepResult::kDone;
  best_ = {quality, false, facet};
  new_cells_.clear();
  for (std::size_t i = 0; i < around_.size(); ++i)
    new_cells_.push_back({cavity_.local_of(bottom_), cavity_.local_of(top_), cavity_.local_of(around_[i]),
                          cavity_.local_of(around_[(i + 1) % around_.size()])});
  return StepResult::kDone;
}

// Plans the cell that replaces facets at the edge xy, or the cells at the edges beyond it if they are better.
template <class Locks>
StepResult Flips<Locks>::plan_side(const AttemptedCell& attempted, const Side& side, double& quality) {
  constexpr int kMaxDepth = 2;
  quality = quality_.of_new(
      {mesh_.point(bottom_), mesh_.point(top_), mesh_.point(side.x), mesh_.point(side.y)}, attempted.bound);
  const std::size_t num_around = around_.size(), num_cells = on_facets_.size();
  if (quality < 1 && side.depth < kMaxDepth) {
    double of_two = 0;
    const StepResult planned = plan_beyond(attempted, side, of_two);
    if (planned == StepResult::kLockConflict) return planned;
    if (planned == StepResult::kDone && of_two > quality) {
      quality = of_two;
      return StepResult::kDone;
    }
    around_.resize(num_around);
    on_facets_.resize(num_cells);
  }
  around_.push_back(side.x);
  return StepResult::kDone;
}

// Plans the cells beyond the edge xy. kOutOfReach: no facet beside xy lies between the same two vertices.
template <class Locks>
StepResult Flips<Locks>::plan_beyond(const AttemptedCell& attempted, const Side& side, double& quality) {
  const FacetId over = beyond(side.over, side.z), under = beyond(side.under, side.z);
  for (const FacetId f : {over, under})
    if (f == kNoFacet || mesh_.label(cell_of(f)) != attempted.label) return StepResult::kOutOfReach;
  const VertexId s = apex_of(mesh_, over);
  if (s != apex_of(mesh_, under) || cavity_.has_vertex(s)) return StepResult::kOutOfReach;
  for (const FacetId f : {over, under})
    if (const StepResult added = cavity_.add(cell_of(f)); added != StepResult::kDone) return added;
  on_facets_.insert(on_facets_.end(), {cell_of(over), cell_of(under)});
  double left = 0, right = 0;
  const Side first{cell_of(over), cell_of(under), side.x, s, side.y, side.depth + 1},
      second{cell_of(over), cell_of(under), s, side.y, side.x, side.depth + 1};
  if (const StepResult planned = plan_side(attempted, first, left); planned != StepResult::kDone)
    return planned;
  if (const StepResult planned = plan_side(attempted, second, right); planned != StepResult::kDone)
    return planned;
  quality = std::min(left, right);
  return StepResult::kDone;
}

template <class Locks>
FacetId Flips<Locks>::beyond(CellId c, VertexId opposite) const {
  const Cell& cell = mesh_.cell(c);
  return cell.mirrors[index_of(cell, opposite)];
}

template class Flips<NoLocks>;
template class Flips<VertexLocks>;

}  // namespace podm
