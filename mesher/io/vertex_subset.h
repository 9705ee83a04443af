// The vertices that some facets or edges use, with numbers of their own, for files that store only these.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace podm {

class VertexSubset {
 public:
  explicit VertexSubset(std::size_t num_mesh_vertices) : position_(num_mesh_vertices, kUnused) {}

  /// Replaces the subset by the vertices of `parts`, facets or edges, in the order of the mesh. Takes time in
  /// proportion to their number.
  template <std::size_t N>
  void assign(const std::vector<std::array<std::uint32_t, N>>& parts) {
    clear();
    for (const auto& part : parts)
      for (const std::uint32_t vertex : part) add(vertex);
    number();
  }

  /// Returns the vertices as positions in the mesh.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  /// Returns the position in vertices() of a mesh vertex that belongs to the subset.
  std::uint32_t position(std::uint32_t mesh_vertex) const { return position_[mesh_vertex]; }

 private:
  void clear();
  void add(std::uint32_t mesh_vertex) {
    if (position_[mesh_vertex] != kUnused) return;
    position_[mesh_vertex] = 0;
    vertices_.push_back(mesh_vertex);
  }
  void number();

  static constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  // A sparse subset has fewer than one in kSparse vertices of the mesh.
  static constexpr std::size_t kSparse = 16;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint32_t> position_;  // one per mesh vertex
};

}  // namespace podm
