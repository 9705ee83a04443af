#include "distributed/vertex_exchange.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "distributed/messages.h"

#include "delaunay/walk.h"
#include "podm/errors.h"

namespace podm {

namespace {

constexpr double kTouching = 0;  // mm; the vertices come from a triangulation, so no two of them coincide

std::uint64_t hash_of(const Point& p) {
  std::uint64_t hash = 0;
  for (const double x : {p.x, p.y, p.z})
    hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
  return (hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u;
}

bool is_shared(VertexKind kind) { return kind != VertexKind::kUnused && kind != VertexKind::kBox; }

}  // namespace

VertexExchange::VertexExchange(Communication& ranks, Mesh& mesh, Pool& pool, const CubeGrid& grid,
                               OperationLogWriter* log)
    : ranks_(ranks),
      mesh_(mesh),
      grid_(grid),
      operation_(mesh, pool, 0),
      log_(log),
      cubes_(grid.num_cubes()) {}

void VertexExchange::note_writer(CubeId cube, int rank) {
  cubes_[cube] = {.writer = rank, .is_up_to_date = rank == ranks_.rank()};
}

CubeSet VertexExchange::known() const {
  CubeSet known(grid_);
  for (CubeId cube = 0; cube < cubes_.size(); ++cube)
    if (cubes_[cube].is_up_to_date) known.insert(cube);
  return known;
}

void VertexExchange::copy_first() {
  if (log_ != nullptr) log_->begin_step();
  CubeSet all(grid_);
  all.insert_all();
  Bytes message;
  if (ranks_.rank() == 0) {
    Bytes question;
    append(question, all.cubes());
    message = answers_to({std::move(question)}).front();
  }
  const std::vector<Bytes> received = ranks_.all_gather(std::move(message));
  if (ranks_.rank() == 0) return;
  Update update;
  std::vector<Change> changes = differences(received, update);
  apply(changes, nullptr);
}

Update VertexExchange::update(const CubeSet& wanted, std::vector<CellId>* made) {
  if (log_ != nullptr) log_->begin_step();
  Update update;
  std::vector<std::vector<CubeId>> asked(static_cast<std::size_t>(ranks_.size()));
  for (const CubeId cube : wanted.cubes()) {
    State& state = cubes_[cube];
    if (state.is_up_to_date) continue;
    asked[static_cast<std::size_t>(state.writer)].push_back(cube);
    state.is_up_to_date = true;
    ++update.cubes;
  }
  std::vector<Bytes> questions(asked.size());
  for (std::size_t rank = 0; rank < asked.size(); ++rank)
    if (!asked[rank].empty()) append(questions[rank], asked[rank]);
  const std::vector<Bytes> received = ranks_.all_to_all(answers_to(ranks_.all_to_all(std::move(questions))));
  std::vector<Change> changes = differences(received, update);
  apply(changes, made);
  return update;
}

// Returns, for each rank, the cubes that it requested and all vertices in them.
std::vector<Bytes> VertexExchange::answers_to(const std::vector<Bytes>& asked) const {
  struct Answer {
    std::size_t rank;
    std::vector<CubeId> cubes;
    std::vector<SentVertex> vertices;
  };
  std::vector<Answer> answers;
  std::unordered_multimap<CubeId, std::size_t> answers_of;  // by cube
  CubeSet asked_for(grid_);
  for (std::size_t rank = 0; rank < asked.size(); ++rank) {
    if (asked[rank].empty()) continue;
    MessageReader question(asked[rank]);
    answers.push_back({rank, question.read<CubeId>(), {}});
    question.expect_end();
    for (const CubeId cube : answers.back().cubes) {
      answers_of.emplace(cube, answers.size() - 1);
      asked_for.insert(cube);
    }
  }
  for (VertexId v = 0; v < mesh_.vertex_bound() && !answers.empty(); ++v) {
    const Vertex& vertex = mesh_.vertex(v);
    if (!is_shared(vertex.kind)) continue;
    const CubeId cube = grid_.cube_at(vertex.point);
    if (!asked_for.has(cube)) continue;
    const auto [first, last] = answers_of.equal_range(cube);
    for (auto it = first; it != last; ++it)
      answers[it->second].vertices.push_back({vertex.point, vertex.kind});
  }
  std::vector<Bytes> messages(asked.size());
  for (const Answer& answer : answers) {
    append(messages[answer.rank], answer.cubes);
    append(messages[answer.rank], answer.vertices);
  }
  return messages;
}

// Compares both sets of vertices in the order of their coordinates.
std::vector<VertexExchange::Change> VertexExchange::differences(const std::vector<Bytes>& received,
                                                                Update& update) const {
  CubeSet cubes(grid_);
  std::vector<Change> theirs, ours, changes;
  for (const Bytes& message : received) {
    if (message.empty()) continue;
    MessageReader reader(message);
    for (const CubeId cube : reader.read<CubeId>()) cubes.insert(cube);
    for (const SentVertex& vertex : reader.read<SentVertex>()) theirs.push_back({vertex.point, vertex.kind});
    reader.expect_end();
  }
  update.vertices_received = theirs.size();
  for (VertexId v = 0; v < mesh_.vertex_bound(); ++v) {
    const Vertex& vertex = mesh_.vertex(v);
    if (is_shared(vertex.kind) && cubes.has(vertex.point))
      ours.push_back({vertex.point, VertexKind::kUnused});
  }
  const auto less = [](const Change& a, const Change& b) { return lexicographically_less(a.point, b.point); };
  std::sort(theirs.begin(), theirs.end(), less);
  std::sort(ours.begin(), ours.end(), less);
  std::set_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(changes),
                      less);
  update.removed = changes.size();
  std::set_difference(theirs.begin(), theirs.end(), ours.begin(), ours.end(), std::back_inserter(changes),
                      less);
  update.inserted = changes.size() - update.removed;
  return changes;
}

// Inserts in rounds of random points, each with twice as many points as the previous one, and along a curve
// within each round. Neighbours in the order are near each other, and cavities are no larger than those of
// points in random order. (Amenta, Choi, Rote, SoCG 2003.)
void VertexExchange::apply(std::vector<Change>& changes, std::vector<CellId>* made) {
  struct Place {
    int rounds_after;
    MortonCode code;
    std::size_t change;
    bool operator<(const Place& b) const {
      return rounds_after != b.rounds_after ? rounds_after > b.rounds_after : code < b.code;
    }
  };
  constexpr int kMostRounds = 10;
  std::vector<Place> order;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const Point& p = changes[i].point;
    order.push_back({std::min(std::countl_zero(hash_of(p)), kMostRounds), grid_.place_on_curve(p), i});
  }
  std::sort(order.begin(), order.end());
  const auto check = [](StepResult result) {
    if (result != StepResult::kDone)
      throw InternalError("vertices received from another rank do not fit in the mesh");
  };
  for (const auto& place : order) {
    const auto& [point, kind] = changes[place.change];
    if (kind == VertexKind::kUnused) {
      const std::optional<Found> found = find_vertex(point);
      if (!found) throw InternalError("a vertex to be removed does not exist");
      check(operation_.plan_removal(found->vertex, found->cell));
      check(operation_.commit_removals());
      note(changes[place.change], found->vertex);
    } else {
      check(operation_.plan_insertion(point, walk_to(point)));
      check(operation_.commit_insertion(point, kind, kTouching));
      note(changes[place.change], operation_.inserted());
    }
    const std::vector<CellId>& created = operation_.created();
    if (made != nullptr) made->insert(made->end(), created.begin(), created.end());
    near_ = created.front();
  }
  flush_log();
}

void VertexExchange::note(const Change& change, VertexId vertex) {
  if (log_ == nullptr) return;
  constexpr std::size_t kEntriesToFlush = 4096;
  const bool is_gone = change.kind == VertexKind::kUnused;
  const auto kind = is_gone ? kReceivedRemoval : kReceivedInsertion + static_cast<std::uint32_t>(change.kind);
  const Point& p = change.point;
  unlogged_.operations.push_back({.sequence = log_->next_sequence(),
                                  .point = {p.x, p.y, p.z},
                                  .vertex = vertex,
                                  .worker = 0,
                                  .kind = kind,
                                  .num_removed = is_gone ? 1u : 0u});
  if (is_gone) unlogged_.removed.push_back(vertex);
  if (unlogged_.operations.size() == kEntriesToFlush) flush_log();
}

void VertexExchange::flush_log() {
  if (log_ == nullptr) return;
  log_->append(unlogged_);
  unlogged_ = {};
}

std::optional<VertexExchange::Found> VertexExchange::find_vertex(const Point& p) {
  near_ = walk_to(p);
  for (const VertexId v : mesh_.cell(near_).vertices)
    if (mesh_.point(v) == p) return Found{near_, v};
  return std::nullopt;
}

// The centroid is in the cell, except for rounding in flat cells. Flat cells are found among the cells around
// the first vertex.
std::optional<CellId> VertexExchange::find_cell(const std::array<Point, 4>& vertices) {
  const auto is_it = [&](CellId c) {
    const Cell& cell = mesh_.cell(c);
    return std::all_of(vertices.begin(), vertices.end(), [&](const Point& p) {
      return std::any_of(cell.vertices.begin(), cell.vertices.end(),
                         [&](VertexId v) { return mesh_.point(v) == p; });
    });
  };
  const Vector sum = (vertices[1] - vertices[0]) + (vertices[2] - vertices[0]) + (vertices[3] - vertices[0]);
  near_ = walk_to(vertices[0] + 0.25 * sum);
  if (is_it(near_)) return near_;
  const std::optional<Found> first = find_vertex(vertices[0]);
  if (!first) return std::nullopt;
  std::vector<CellId> around{first->cell};
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Cell& cell = mesh_.cell(around[i]);
    if (is_it(around[i])) return around[i];
    for (unsigned k = 0; k < 4; ++k) {
      if (cell.vertices[k] == first->vertex || cell.mirrors[k] == kNoFacet) continue;
      const CellId beside = cell_of(cell.mirrors[k]);
      if (std::find(around.begin(), around.end(), beside) == around.end()) around.push_back(beside);
    }
  }
  return std::nullopt;
}

CellId VertexExchange::walk_to(const Point& p) {
  while (near_ >= mesh_.cell_bound() || !mesh_.cell(near_).is_alive())
    near_ = near_ + 1 < mesh_.cell_bound() ? near_ + 1 : 0;
  return cell_with(mesh_, p, near_);
}

}  // namespace podm
