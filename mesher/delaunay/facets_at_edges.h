// Finds where the cells of a star meet: the facet over each directed edge of the star's outside.
#pragma once

#include <bit>
#include <cstddef>
#include <vector>

#include "delaunay/mesh.h"

namespace podm {

/// Vertices are given by their numbers in the star. The facet over (a,b) coincides with the facet over (b,a).
class FacetsAtEdges {
 public:
  /// The table of one star, for loops that write to other memory in between.
  class Table {
   public:
    Table() = default;
    FacetId& over(unsigned a, unsigned b) const { return facets_[(a << row_bits_) + b]; }

   private:
    friend class FacetsAtEdges;
    Table(FacetId* facets, unsigned row_bits) : facets_(facets), row_bits_(row_bits) {}
    FacetId* facets_ = nullptr;
    unsigned row_bits_ = 0;
  };

  /// Returns the table of a star, which is valid until the next call.
  Table begin(unsigned num_vertices) {
    // Rows are as short as the number of vertices allows. A usual table therefore fits in the first-level
    // cache.
    const auto row_bits = static_cast<unsigned>(std::bit_width(num_vertices - 1));
    const std::size_t size = std::size_t{1} << (2 * row_bits);
    if (facets_.size() < size) facets_.resize(size);
    return {facets_.data(), row_bits};
  }

 private:
  std::vector<FacetId> facets_;
};

}  // namespace podm
