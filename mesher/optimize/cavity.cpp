#include "optimize/cavity.h"

#include <algorithm>
#include <limits>
#include <span>

#include "delaunay/lock_to_read.h"
#include "delaunay/planted_fault.h"
#include "podm/errors.h"

namespace podm {

namespace {

std::uint32_t sorted_key(const LocalFacet& facet) {
  auto [a, b, c] = facet;
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  return static_cast<std::uint32_t>(a << 16 | b << 8 | c);
}

}  // namespace

template <class Locks>
StepResult Cavity<Locks>::reserve(CellId c, std::uint32_t stamp) {
  const StepResult result =
      lock_to_read<Locks>(mesh_, c, stamp, [this](VertexId v) { return locks_.try_lock(mesh_.vertex(v)); });
  if (result != StepResult::kDone) locks_.unlock_all();
  return result;
}

template <class Locks>
void Cavity<Locks>::release() {
  clear();
  forget_reads();
  locks_.unlock_all();
}

template <class Locks>
void Cavity<Locks>::clear() {
  cells_.clear();
  vertices_.clear();
  ids_.clear();
  points_.clear();
}

template <class Locks>
bool Cavity<Locks>::has(CellId c) const {
  return std::find(cells_.begin(), cells_.end(), c) != cells_.end();
}

template <class Locks>
bool Cavity<Locks>::has_vertex(VertexId v) const {
  return std::find(ids_.begin(), ids_.end(), v) != ids_.end();
}

template <class Locks>
void Cavity<Locks>::number(VertexId v) {
  Vertex& vertex = mesh_.vertex(v);
  if (vertex.local_index < ids_.size() && ids_[vertex.local_index] == v) return;
  vertex.local_index = static_cast<std::uint16_t>(ids_.size());
  ids_.push_back(v);
  points_.push_back(vertex.point);
}

template <class Locks>
StepResult Cavity<Locks>::add(CellId c) {
  if (has(c)) return StepResult::kDone;
  const std::array<VertexId, 4> vertices = mesh_.cell(c).vertices;
  for (const VertexId v : std::span(vertices).first(locks_taken().in_cavity)) {
    if (const StepResult locked = locks_.try_lock(mesh_.vertex(v)); locked != StepResult::kDone)
      return locked;
  }
  if (ids_.size() + 4 > kMaxVertices) return StepResult::kTooNear;
  LocalCell local;
  for (unsigned i = 0; i < 4; ++i) {
    number(vertices[i]);
    local[i] = local_of(vertices[i]);
  }
  cells_.push_back(c);
  vertices_.push_back(local);
  return StepResult::kDone;
}

// Passes through cells that the cavity already has, and therefore keeps its own list.
template <class Locks>
StepResult Cavity<Locks>::add_ball(VertexId v, CellId seed, LabelIndex label) {
  ball_.assign(1, seed);
  for (std::size_t i = 0; i < ball_.size(); ++i) {
    const CellId c = ball_[i];
    if (mesh_.label(c) != label) return StepResult::kOutOfReach;
    if (const StepResult added = add(c); added != StepResult::kDone) return added;
    const Cell& cell = mesh_.cell(c);
    for (unsigned k = 0; k < 4; ++k) {
      if (cell.vertices[k] == v) continue;
      if (cell.mirrors[k] == kNoFacet) return StepResult::kOutOfReach;
      const CellId neighbor = cell_of(cell.mirrors[k]);
      if (std::find(ball_.begin(), ball_.end(), neighbor) == ball_.end()) ball_.push_back(neighbor);
    }
  }
  return StepResult::kDone;
}

template <class Locks>
double Cavity<Locks>::worst(const OptimizationQuality& quality) const {
  double worst = std::numeric_limits<double>::infinity();
  for (const LocalCell& cell : vertices_) worst = std::min(worst, quality.of(points_of(cell)));
  return worst;
}

template <class Locks>
Local Cavity<Locks>::add_point(const Point& p) {
  ids_.push_back(kNoVertex);
  points_.push_back(p);
  return static_cast<Local>(ids_.size() - 1);
}

template <class Locks>
void Cavity<Locks>::collect_boundary(std::vector<LocalFacet>& facets) const {
  facets.clear();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh_.cell(cells_[i]).mirrors[k];
      if (mirror != kNoFacet && has(cell_of(mirror))) continue;
      facets.push_back(facet_of(vertices_[i], k));
    }
  }
}

// Makes the two sides of each facet adjacent in sides_. Throws InternalError if a facet does not have two
// sides.
template <class Locks>
void Cavity<Locks>::match(const std::vector<LocalCell>& cells) {
  sides_.clear();
  outer_.clear();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh_.cell(cells_[i]).mirrors[k];
      if (mirror != kNoFacet && has(cell_of(mirror))) continue;
      sides_.push_back(
          {sorted_key(facet_of(vertices_[i], k)), static_cast<std::uint32_t>(outer_.size()), true});
      outer_.push_back(mirror);
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (unsigned k = 0; k < 4; ++k)
      sides_.push_back({sorted_key(facet_of(cells[i], k)), static_cast<std::uint32_t>(4 * i + k), false});
  std::sort(sides_.begin(), sides_.end(), [](const FacetSide& a, const FacetSide& b) {
    return a.key != b.key ? a.key < b.key : a.facet < b.facet;
  });
  bool is_matched = sides_.size() % 2 == 0;
  for (std::size_t i = 0; is_matched && i < sides_.size(); i += 2) {
    is_matched = sides_[i].key == sides_[i + 1].key && !(sides_[i].is_outer && sides_[i + 1].is_outer) &&
                 (i + 2 == sides_.size() || sides_[i + 1].key != sides_[i + 2].key);
  }
  if (!is_matched) throw InternalError("the cells for a cavity have another boundary than the cavity");
}

template <class Locks>
void Cavity<Locks>::replace_by(const std::vector<LocalCell>& cells, LabelIndex label, VertexKind kind) {
  match(cells);
  std::array<bool, kMaxVertices + 1> is_used{};
  for (const LocalCell& cell : cells)
    for (const Local v : cell) is_used[v] = true;
  created_.reserve(cells.size());
  const auto num_unused = std::count(is_used.begin(), is_used.begin() + std::ssize(ids_), false);
  pool_.reserve(cells_, cells.size(), static_cast<std::size_t>(num_unused));
  for (std::size_t v = 0; v < ids_.size(); ++v) {  // nothing below throws
    if (ids_[v] != kNoVertex || !is_used[v]) continue;
    ids_[v] = pool_.take_vertex();
    place(mesh_.vertex(ids_[v]), points_[v], kind);
  }
  pool_.replace(cells_, cells.size(), created_);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const LocalCell& c = cells[i];
    mesh_.renew(created_[i], {ids_[c[0]], ids_[c[1]], ids_[c[2]], ids_[c[3]]});
    mesh_.label(created_[i]) = label;
  }
  const auto id_of = [&](const FacetSide& side) {
    return side.is_outer ? outer_[side.facet] : 4 * created_[side.facet / 4] + side.facet % 4;
  };
  for (std::size_t i = 0; i < sides_.size(); i += 2) {
    mesh_.set_mirror(id_of(sides_[i]), id_of(sides_[i + 1]));
    mesh_.set_mirror(id_of(sides_[i + 1]), id_of(sides_[i]));
  }
  for (std::size_t v = 0; v < ids_.size(); ++v)
    if (ids_[v] != kNoVertex && !is_used[v]) pool_.release_vertex(ids_[v]);
  net_cells_ += static_cast<std::int64_t>(cells.size()) - static_cast<std::int64_t>(cells_.size());
  clear();
}

template class Cavity<NoLocks>;
template class Cavity<VertexLocks>;

}  // namespace podm
