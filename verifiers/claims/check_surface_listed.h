// Compares the triangles that a mesh file lists with the facets between cells of different labels.
#pragma once

#include <cstdint>
#include <vector>

#include "claims/check_surface_boundary.h"

namespace podm::verify {

/// The findings of a rank at its own vertices. Numbers are positions in Mesh::facets.
struct ListedFacets {
  std::uint64_t missing = 0;               ///< facets between different labels that the file does not list
  std::vector<std::uint32_t> stray;        ///< listed, but not between different labels, or listed before
  std::vector<std::uint32_t> mislabelled;  ///< listed with other labels than the cells have
  std::vector<std::uint32_t> turned;       ///< unlike most, the normal is not from second label to first
};

/// Collective.
ListedFacets inspect_listed_facets(const Mesh& mesh, const CellLabelIndices& label_indices,
                                   const std::vector<Side>& sides, const SidesOfVertex& sides_of);

}  // namespace podm::verify
