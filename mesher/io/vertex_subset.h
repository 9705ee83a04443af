// The vertices that some facets use, with numbers of their own, for files that store only a surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace podm {

class VertexSubset {
 public:
  explicit VertexSubset(std::size_t num_mesh_vertices) : position_(num_mesh_vertices, kUnused) {}

  /// Replaces the subset by the vertices of `facets`, in the order of the mesh. Takes time in proportion to
  /// the number of `facets`.
  void assign(const std::vector<std::array<std::uint32_t, 3>>& facets);

  /// Returns the vertices as positions in the mesh.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  /// Returns the position in vertices() of a mesh vertex that belongs to the subset.
  std::uint32_t position(std::uint32_t mesh_vertex) const { return position_[mesh_vertex]; }

 private:
  static constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  // A sparse subset has fewer than one in kSparse vertices of the mesh.
  static constexpr std::size_t kSparse = 16;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint32_t> position_;  // one per mesh vertex
};

}  // namespace podm
