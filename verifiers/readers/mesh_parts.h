// What the readers of all formats share: limits, names of other cells, and what label arrays are called.
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
inline constexpr std::uint64_t kMostCells = kNone / 4;  ///< so that 4 * cell + i fits 32 bits

inline constexpr const char* kQuadraticTetrahedra = "quadratic tetrahedra (corners read)";
inline constexpr const char* kQuadraticTriangles = "quadratic triangles (corners read)";

/// Throws InputError at `place` when the mesh would get too large for 32-bit ids.
void check_counts(const MeshFile& file, const std::string& place, std::uint64_t num_vertices,
                  std::uint64_t num_cells);

/// Room for `count` more, at least twice what there is, so that many small additions stay linear.
template <class Item>
void make_room(std::vector<Item>& items, std::size_t count) {
  if (count > items.capacity() - items.size())
    items.reserve(std::max(items.size() + count, 2 * items.size()));
}

/// How usual `name` is for an array of cell labels: 0 the most; none when it is no such name. Case is
/// ignored.
std::optional<std::size_t> label_array_rank(std::string_view name);

/// The space that our mesher's word names; none for any other word.
std::optional<Space> space_of(std::string_view word);

/// Our mesher's words on what the mesh is to keep and what not: "unclaimed delaunay", "dihedral 8 165",
/// "smoothed 1.5".
/// Throws InputError at `place` for others.
void read_promise(const MeshFile& file, const std::string& place, std::string_view words, Mesh& mesh);

/// The rest of `text` after `prefix`; none where it does not begin so.
std::optional<std::string_view> after_prefix(std::string_view text, std::string_view prefix);

/// Takes the leading integer and the blank after it off `text`; none, and `text` as it was, where there is
/// none.
std::optional<std::int64_t> take_integer(std::string_view& text);

}  // namespace podm::verify
