#include "distributed/overlap.h"

#include <fmt/format.h>

#include <atomic>
#include <vector>

#include "distributed/messages.h"
#include "distributed/vertex_source.h"
#include "geometry/point_hash.h"
#include "podm/errors.h"
#include "runtime/mix.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

struct VerticesOfCube {
  std::uint64_t number = 0, hash = 0;
  bool operator==(const VerticesOfCube&) const = default;
};
struct Copy {
  CubeId cube;
  VerticesOfCube vertices;
};

// Returns, by cube, the vertices in the cubes of the set.
std::vector<VerticesOfCube> vertices_by_cube(const Mesh& mesh, const CubeSet& cubes, std::size_t threads) {
  constexpr std::size_t kLength = 1 << 14;
  std::vector<VerticesOfCube> of_cube(cubes.grid().num_cubes());
  const auto add = [&](const Vertex& vertex) {
    if (!is_shared(vertex.kind)) return;
    const CubeId cube = cubes.grid().cube_at(vertex.point);
    if (!cubes.has(cube)) return;
    // Relaxed: sums are read after all threads have ended.
    std::atomic_ref(of_cube[cube].number).fetch_add(1, std::memory_order_relaxed);
    std::atomic_ref(of_cube[cube].hash)
        .fetch_add(mix(PointHash()(vertex.point) + static_cast<std::uint64_t>(vertex.kind)),
                   std::memory_order_relaxed);
  };
  parallel_for_ranges(mesh.vertex_bound(), kLength, threads,
                      [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t v = begin; v < end; ++v) add(mesh.vertex(static_cast<VertexId>(v)));
                      });
  return of_cube;
}

[[noreturn]] void throw_difference(const CubeGrid& grid, const Copy& theirs, const VerticesOfCube& ours,
                                   int rank, int writer) {
  const Point low = grid.low_of(grid.place_of(theirs.cube));
  throw InternalError(fmt::format(
      "the copy of rank {} of the cube of side {:.6g} mm at ({:.6g} {:.6g} {:.6g}) mm has {} vertices; "
      "rank {}, which wrote the cube, has {}{}",
      rank, grid.side_mm(), low.x, low.y, low.z, theirs.vertices.number, writer, ours.number,
      theirs.vertices.number == ours.number ? " other ones" : ""));
}

}  // namespace

void check_overlap(const Mesh& mesh, const CubeSet& known, const std::vector<int>& writer_of_cube,
                   std::size_t threads, Communication& ranks) {
  const std::vector<VerticesOfCube> ours = vertices_by_cube(mesh, known, threads);
  std::vector<std::vector<Copy>> copies(static_cast<std::size_t>(ranks.size()));
  for (const CubeId cube : known.cubes())
    if (const int writer = writer_of_cube[cube]; writer != ranks.rank())
      copies[static_cast<std::size_t>(writer)].push_back({cube, ours[cube]});
  std::vector<Bytes> messages(copies.size());
  for (std::size_t rank = 0; rank < copies.size(); ++rank)
    if (!copies[rank].empty()) append(messages[rank], copies[rank]);
  const std::vector<Bytes> received = ranks.all_to_all(std::move(messages));
  for (std::size_t rank = 0; rank < received.size(); ++rank) {
    if (received[rank].empty()) continue;
    MessageReader reader(received[rank]);
    for (const Copy& theirs : reader.read<Copy>())
      if (theirs.vertices != ours.at(theirs.cube))
        throw_difference(known.grid(), theirs, ours[theirs.cube], static_cast<int>(rank), ranks.rank());
    reader.expect_end();
  }
}

}  // namespace podm
