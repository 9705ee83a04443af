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

// The vertices in the cubes of a set.
class VerticesByCube {
 public:
  VerticesByCube(const Mesh& mesh, const CubeSet& cubes, std::size_t threads)
      : number_of_(cubes), of_cube_(number_of_.count()) {
    constexpr std::size_t kLength = 1 << 12;
    parallel_for_ranges(mesh.vertex_bound(), kLength, threads,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t v = begin; v < end; ++v)
                            add(mesh.vertex(static_cast<VertexId>(v)));
                        });
  }
  /// The cube must be one of the set.
  const VerticesOfCube& operator[](CubeId cube) const { return of_cube_[number_of_[cube]]; }

 private:
  void add(const Vertex& vertex) {
    if (!is_shared(vertex.kind)) return;
    const CubeId cube = number_of_.cubes().grid().cube_at(vertex.point);
    if (!number_of_.cubes().has(cube)) return;
    VerticesOfCube& here = of_cube_[number_of_[cube]];
    // Relaxed: sums are read after all threads have ended.
    std::atomic_ref(here.number).fetch_add(1, std::memory_order_relaxed);
    std::atomic_ref(here.hash).fetch_add(
        mix(PointHash()(vertex.point) + static_cast<std::uint64_t>(vertex.kind)), std::memory_order_relaxed);
  }

  const CubeNumbers number_of_;
  std::vector<VerticesOfCube> of_cube_;
};

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

void check_overlap(const Mesh& mesh, const CubeSet& known, const std::function<int(CubeId)>& writer_of,
                   std::size_t threads, Communication& ranks) {
  const VerticesByCube ours(mesh, known, threads);
  std::vector<std::vector<Copy>> copies(static_cast<std::size_t>(ranks.size()));
  for (const CubeId cube : known.cubes())
    if (const int writer = writer_of(cube); writer != ranks.rank())
      copies[static_cast<std::size_t>(writer)].push_back({cube, ours[cube]});
  const std::vector<Bytes> received = ranks.all_to_all(messages_of(copies));
  for (std::size_t rank = 0; rank < received.size(); ++rank) {
    for (const Copy& theirs : values_of<Copy>(received[rank])) {
      if (!known.has(theirs.cube))
        throw InternalError(
            fmt::format("rank {} takes rank {} for the writer of cube {}, which it does not know", rank,
                        ranks.rank(), theirs.cube));
      if (theirs.vertices != ours[theirs.cube])
        throw_difference(known.grid(), theirs, ours[theirs.cube], static_cast<int>(rank), ranks.rank());
    }
  }
}

}  // namespace podm
