// Parts that the readers of all formats share: limits, names of other cells, and names of label arrays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

inline constexpr std::uint64_t kMostVertices = kNone;   ///< ids below kNone
inline constexpr std::uint64_t kMostCells = kNone / 4;  ///< 4 * cell + i fits 32 bits

inline constexpr const char* kQuadraticTetrahedra = "quadratic tetrahedra (corners read)";
inline constexpr const char* kQuadraticTriangles = "quadratic triangles (corners read)";

/// Throws InputError at `place` if the mesh would be too large for 32-bit ids.
void check_counts(const MeshFile& file, const std::string& place, std::uint64_t num_vertices,
                  std::uint64_t num_cells);

/// Reserves room for `count` more items and at least doubles the size. Many small additions therefore take
/// linear time.
template <class Item>
void make_room(std::vector<Item>& items, std::size_t count) {
  if (count > items.capacity() - items.size())
    items.reserve(std::max(items.size() + count, 2 * items.size()));
}

/// Returns the rank of `name` among the usual names of arrays of cell labels: 0 for the most usual, none for
/// any other name. Case is ignored.
std::optional<std::size_t> label_array_rank(std::string_view name);

/// Returns the space for podm's word for it; none for any other word.
std::optional<Space> space_of(std::string_view word);

/// Reads a promise that podm writes about the mesh: "unclaimed delaunay", "dihedral 8 165", "smoothed 1.5".
/// Throws InputError at `place` for any other words.
void read_promise(const MeshFile& file, const std::string& place, std::string_view words, Mesh& mesh);

/// Returns the rest of `text` after `prefix`; none if `text` does not begin with it.
std::optional<std::string_view> after_prefix(std::string_view text, std::string_view prefix);

/// Removes the leading integer and the blank after it, if any, from `text` and returns the integer. Returns
/// none, and leaves `text` as it is, if no integer is there.
std::optional<std::int64_t> take_integer(std::string_view& text);

}  // namespace podm::verify
