#include "distributed/vertex_exchange.h"

#include <algorithm>

#include "distributed/messages.h"
#include "distributed/overlap.h"
#include "runtime/parallel_collect.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

bool is_less(const LearntVertex& a, const LearntVertex& b) {
  return lexicographically_less(a.point, b.point);
}

}  // namespace

// A rank may have changed the cubes of its zone that no cell requested, too.
void VertexExchange::note_writers(Zones zones, const CubeSet& own) {
  if (zones.are_blocks()) {
    known_ = own;
  } else {
    for (const CubeId cube : known_.cubes())
      if (zones.rank_of(grid_.place_of(cube)) != kNoRank) known_.erase(cube);
    known_.insert(own);
  }
  writers_.note(std::move(zones));
}

CubeSet VertexExchange::written() const {
  CubeSet written(grid_);
  for (const CubeId cube : known_.cubes())
    if (writers_.of(cube) == ranks_.rank()) written.insert(cube);
  return written;
}

Update VertexExchange::update(const CubeSet& wanted, std::vector<CellId>* made) {
  if (learner_.log() != nullptr) learner_.log()->begin_step();
  Update update;
  std::vector<std::vector<CubeId>> asked(static_cast<std::size_t>(ranks_.size()));
  for (const CubeId cube : wanted.cubes()) {
    if (known_.has(cube)) continue;
    asked[static_cast<std::size_t>(writers_.of(cube))].push_back(cube);
    known_.insert(cube);
    ++update.cubes;
  }
  const std::vector<Bytes> received = ranks_.all_to_all(answers_to(ranks_.all_to_all(messages_of(asked))));
  learner_.learn(differences(received, update), kReceivedInsertion, made);
  return update;
}

void VertexExchange::check() const {
  check_overlap(
      learner_.mesh(), known_, [&](CubeId cube) { return writers_.of(cube); }, learner_.threads(), ranks_);
}

// Returns, for each rank, the cubes that it requested and all vertices in them.
std::vector<Bytes> VertexExchange::answers_to(const std::vector<Bytes>& asked) const {
  std::vector<std::vector<CubeId>> cubes_for(asked.size());  // by rank
  CubeSet asked_for(grid_);
  for (std::size_t rank = 0; rank < asked.size(); ++rank) {
    cubes_for[rank] = values_of<CubeId>(asked[rank]);
    for (const CubeId cube : cubes_for[rank]) asked_for.insert(cube);
  }
  struct InCube {
    CubeId cube;
    SentVertex vertex;
  };
  const Mesh& mesh = learner_.mesh();
  auto vertices =
      parallel_collect<InCube>(asked_for.range().is_empty() ? 0 : mesh.vertex_bound(), learner_.threads(),
                               [&](std::size_t begin, std::size_t end, std::vector<InCube>& found) {
                                 for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
                                   const Vertex& vertex = mesh.vertex(v);
                                   if (!is_shared(vertex.kind)) continue;
                                   const CubeId cube = grid_.cube_at(vertex.point);
                                   if (asked_for.has(cube))
                                     found.push_back({cube, {vertex.point, vertex.kind}});
                                 }
                               });
  const auto by_cube = [](const InCube& a, const InCube& b) { return a.cube < b.cube; };
  parallel_sort(vertices.begin(), vertices.end(), learner_.threads(), by_cube);
  std::vector<Bytes> messages(asked.size());
  parallel_for(asked.size(), learner_.threads(), [&](std::size_t rank, std::size_t) {
    if (cubes_for[rank].empty()) return;
    std::vector<SentVertex> answer;
    for (const CubeId cube : cubes_for[rank]) {
      const auto [first, last] =
          std::equal_range(vertices.begin(), vertices.end(), InCube{cube, {}}, by_cube);
      for (auto it = first; it != last; ++it) answer.push_back(it->vertex);
    }
    append(messages[rank], cubes_for[rank]);
    append(messages[rank], answer);
  });
  return messages;
}

// Returns the vertices of `all` that are not among `others`. Both are sorted by coordinates.
std::vector<LearntVertex> VertexExchange::missing(const std::vector<LearntVertex>& all,
                                                  const std::vector<LearntVertex>& others) const {
  return parallel_collect<LearntVertex>(
      all.size(), learner_.threads(),
      [&](std::size_t begin, std::size_t end, std::vector<LearntVertex>& found) {
        auto other = std::lower_bound(others.begin(), others.end(), all[begin], is_less);
        for (std::size_t i = begin; i < end; ++i) {
          while (other != others.end() && is_less(*other, all[i])) ++other;
          if (other == others.end() || is_less(all[i], *other)) found.push_back(all[i]);
        }
      });
}

// Returns our vertices that they lack, to be removed, then their vertices that we lack.
std::vector<LearntVertex> VertexExchange::differences(const std::vector<Bytes>& received,
                                                      Update& update) const {
  CubeSet cubes(grid_);
  std::vector<LearntVertex> theirs;
  for (const Bytes& message : received) {
    if (message.empty()) continue;
    MessageReader reader(message);
    for (const CubeId cube : reader.read<CubeId>()) cubes.insert(cube);
    for (const SentVertex& vertex : reader.read<SentVertex>()) theirs.push_back({vertex.point, vertex.kind});
    reader.expect_end();
  }
  update.vertices_received = theirs.size();
  if (update.cubes == 0) return {};
  const Mesh& mesh = learner_.mesh();
  auto ours = parallel_collect<LearntVertex>(
      mesh.vertex_bound(), learner_.threads(),
      [&](std::size_t begin, std::size_t end, std::vector<LearntVertex>& found) {
        for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
          const Vertex& vertex = mesh.vertex(v);
          if (is_shared(vertex.kind) && cubes.has(vertex.point))
            found.push_back({vertex.point, VertexKind::kUnused});
        }
      });
  parallel_sort(theirs.begin(), theirs.end(), learner_.threads(), is_less);
  parallel_sort(ours.begin(), ours.end(), learner_.threads(), is_less);
  std::vector<LearntVertex> changes = missing(ours, theirs);
  update.removed = changes.size();
  const std::vector<LearntVertex> inserted = missing(theirs, ours);
  update.inserted = inserted.size();
  changes.insert(changes.end(), inserted.begin(), inserted.end());
  return changes;
}

}  // namespace podm
