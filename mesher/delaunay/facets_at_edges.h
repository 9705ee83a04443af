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
  void begin(unsigned num_vertices) {
    row_bits_ = static_cast<unsigned>(std::bit_width(num_vertices - 1));
    if (facets_.size() < std::size_t{1} << (2 * row_bits_)) facets_.resize(std::size_t{1} << (2 * row_bits_));
  }
  FacetId& over(unsigned a, unsigned b) { return facets_[(a << row_bits_) + b]; }

 private:
  // Rows are as short as the number of vertices allows. A usual table therefore fits in the first-level
  // cache.
  std::vector<FacetId> facets_;
  unsigned row_bits_ = 0;
};

}  // namespace podm
