// The vertices that some facets use, numbered on their own: what a file of a surface alone stores.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace podm {

class VertexSubset {
 public:
  explicit VertexSubset(std::size_t num_mesh_vertices) : position_(num_mesh_vertices, kUnused) {}

  /// Replaces the subset by the vertices of `facets`, in the order of the mesh. Costs what `facets` cost.
  void assign(const std::vector<std::array<std::uint32_t, 3>>& facets);

  /// Vertices of the mesh.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  /// Position in vertices() of a mesh vertex that belongs to the subset.
  std::uint32_t position(std::uint32_t mesh_vertex) const { return position_[mesh_vertex]; }

 private:
  static constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  static constexpr std::size_t kSparse = 16;  // fewer than one vertex of the mesh in so many
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint32_t> position_;  // one a mesh vertex
};

}  // namespace podm
