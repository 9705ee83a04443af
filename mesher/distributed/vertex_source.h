// A source of the vertices that a rank does not have yet.
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "distributed/cubes.h"

namespace podm {

/// Returns true for vertices that ranks exchange. All ranks have the corners of the virtual box.
constexpr bool is_shared(VertexKind kind) { return kind != VertexKind::kUnused && kind != VertexKind::kBox; }

/// The cost of one update.
struct Update {
  std::uint64_t cubes = 0;              // cubes received
  std::uint64_t vertices_received = 0;  // vertices received in them
  std::uint64_t inserted = 0, removed = 0;

  Update& operator+=(const Update& b) {
    cubes += b.cubes;
    vertices_received += b.vertices_received;
    inserted += b.inserted;
    removed += b.removed;
    return *this;
  }
};

class VertexSource {
 public:
  VertexSource() = default;
  VertexSource(const VertexSource&) = delete;
  VertexSource& operator=(const VertexSource&) = delete;
  virtual ~VertexSource() = default;

  /// Returns the cubes whose current vertices this rank has.
  virtual CubeSet known() const = 0;
  /// Updates the vertices in these cubes. Each rank passes its own cubes. Adds the cells that the update
  /// makes to `made`, some more than once, including cells that die again.
  virtual Update update(const CubeSet& wanted, std::vector<CellId>* made) = 0;
};

}  // namespace podm
