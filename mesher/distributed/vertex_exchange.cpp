#include "distributed/vertex_exchange.h"

#include <algorithm>
#include <unordered_map>

#include "distributed/messages.h"
#include "distributed/overlap.h"
#include "runtime/parallel_collect.h"

namespace podm {

void VertexExchange::begin(const std::vector<int>& writer_of_cube, const CubeSet& known) {
  writer_of_ = writer_of_cube;
  known_ = known;
}

void VertexExchange::note_writer(CubeId cube, int rank) {
  writer_of_[cube] = rank;
  rank == ranks_.rank() ? known_.insert(cube) : known_.erase(cube);
}

Update VertexExchange::update(const CubeSet& wanted, std::vector<CellId>* made) {
  if (learner_.log() != nullptr) learner_.log()->begin_step();
  Update update;
  std::vector<std::vector<CubeId>> asked(static_cast<std::size_t>(ranks_.size()));
  for (const CubeId cube : wanted.cubes()) {
    if (known_.has(cube)) continue;
    asked[static_cast<std::size_t>(writer_of_[cube])].push_back(cube);
    known_.insert(cube);
    ++update.cubes;
  }
  const std::vector<Bytes> received = ranks_.all_to_all(answers_to(ranks_.all_to_all(messages_of(asked))));
  learner_.learn(differences(received, update), kReceivedInsertion, made);
  return update;
}

void VertexExchange::check() const {
  check_overlap(learner_.mesh(), known_, writer_of_, learner_.threads(), ranks_);
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
  if (answers.empty()) return std::vector<Bytes>(asked.size());
  struct InCube {
    CubeId cube;
    SentVertex vertex;
  };
  const Mesh& mesh = learner_.mesh();
  const auto vertices = parallel_collect<InCube>(mesh.vertex_bound(), learner_.threads(),
                                                 [&](std::size_t begin, std::size_t end, auto& found) {
                                                   for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
                                                     const Vertex& vertex = mesh.vertex(v);
                                                     if (!is_shared(vertex.kind)) continue;
                                                     const CubeId cube = grid_.cube_at(vertex.point);
                                                     if (asked_for.has(cube))
                                                       found.push_back({cube, {vertex.point, vertex.kind}});
                                                   }
                                                 });
  for (const InCube& found : vertices) {
    const auto [first, last] = answers_of.equal_range(found.cube);
    for (auto it = first; it != last; ++it) answers[it->second].vertices.push_back(found.vertex);
  }
  std::vector<Bytes> messages(asked.size());
  for (const Answer& answer : answers) {
    append(messages[answer.rank], answer.cubes);
    append(messages[answer.rank], answer.vertices);
  }
  return messages;
}

// Compares both sets of vertices in the order of their coordinates.
std::vector<LearntVertex> VertexExchange::differences(const std::vector<Bytes>& received,
                                                      Update& update) const {
  CubeSet cubes(grid_);
  std::vector<LearntVertex> theirs, changes;
  for (const Bytes& message : received) {
    if (message.empty()) continue;
    MessageReader reader(message);
    for (const CubeId cube : reader.read<CubeId>()) cubes.insert(cube);
    for (const SentVertex& vertex : reader.read<SentVertex>()) theirs.push_back({vertex.point, vertex.kind});
    reader.expect_end();
  }
  update.vertices_received = theirs.size();
  if (update.cubes == 0) return changes;
  const Mesh& mesh = learner_.mesh();
  auto ours = parallel_collect<LearntVertex>(mesh.vertex_bound(), learner_.threads(),
                                             [&](std::size_t begin, std::size_t end, auto& found) {
                                               for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
                                                 const Vertex& vertex = mesh.vertex(v);
                                                 if (is_shared(vertex.kind) && cubes.has(vertex.point))
                                                   found.push_back({vertex.point, VertexKind::kUnused});
                                               }
                                             });
  const auto less = [](const LearntVertex& a, const LearntVertex& b) {
    return lexicographically_less(a.point, b.point);
  };
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

}  // namespace podm
