#include "distributed/restoring.h"

#include "distributed/messages.h"
#include "distributed/seeding.h"
#include "distributed/vertex_exchange.h"
#include "runtime/parallel_collect.h"

namespace podm {

std::vector<LearntVertex> shared_vertices(const Mesh& mesh, const CubeSet& cubes, std::size_t threads) {
  return parallel_collect<LearntVertex>(mesh.vertex_bound(), threads,
                                        [&](std::size_t begin, std::size_t end, auto& found) {
                                          for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
                                            const Vertex& vertex = mesh.vertex(v);
                                            if (is_shared(vertex.kind) && cubes.has(vertex.point))
                                              found.push_back({vertex.point, vertex.kind});
                                          }
                                        });
}

std::vector<LearntVertex> vertices_to_restore(const Checkpoints& checkpoints, const Blocks& blocks,
                                              const CubeGrid& grid, Communication& ranks) {
  std::vector<std::vector<LearntVertex>> of_rank(static_cast<std::size_t>(ranks.size()));
  for (const LearntVertex& vertex : checkpoints.read())
    of_rank.at(static_cast<std::size_t>(blocks.of(grid.place_of(vertex.point)))).push_back(vertex);
  std::vector<LearntVertex> own = exchanged(of_rank, ranks);
  const std::vector<LearntVertex> some = sparse_around(blocks.range_of(ranks.rank()), grid, own);
  for (int rank = 0; rank < ranks.size(); ++rank)
    of_rank[static_cast<std::size_t>(rank)] =
        rank == ranks.rank() ? std::vector<LearntVertex>() : sparse_around(blocks.range_of(rank), grid, some);
  const std::vector<LearntVertex> elsewhere = exchanged(of_rank, ranks);
  of_rank = {};
  own.insert(own.end(), elsewhere.begin(), elsewhere.end());
  return own;
}

}  // namespace podm
