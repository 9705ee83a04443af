// Parts that the readers of all formats share: limits, names of other cells, and names of label arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"
#include "readers/number_array.h"

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

/// Reads a note of podm about the mesh, in which `blank` follows the first word: its space ("space RAS") or a
/// promise ("promise unclaimed delaunay", "promise dihedral 8 165", "promise smoothed 1.5"). Returns false
/// for any other note. Throws InputError at `place` for an unknown promise.
bool read_note(const MeshFile& file, const std::string& place, std::string_view note, Mesh& mesh,
               char blank = ' ');

/// The number of a side of a flat box in Mesh::facet_sides, by the name of its set, "box i-"; 0 for other
/// names.
std::uint8_t side_of_set(std::string_view name);
/// The same by the name of the facets of a pair of labels on a side: "liver|outside box i-".
std::uint8_t side_of_pair(std::string_view name);

/// The labels and the side that podm states for facets to which the file gives a number.
struct FacetGroup {
  std::array<LabelValue, 2> labels{};
  std::uint8_t side = 0;  ///< as in Mesh::facet_sides
};
using FacetGroups = std::map<std::int64_t, FacetGroup>;
/// Reads a comment of podm: a blank and a note, "label 1 liver", or "pair 7 0 1 liver|outside" of the facets
/// of number 7.
void read_comment(const MeshFile& file, std::string_view text, Mesh& mesh, FacetGroups& groups);
/// Appends the labels and sides of facets by their numbers. Throws InputError at `place` if a number, called
/// `what`, has no pair.
void label_facets(const MeshFile& file, const std::string& place, const char* what,
                  const std::vector<std::int64_t>& numbers, const FacetGroups& groups, Mesh& mesh);

/// A side of a cell, as cell * 4 + its number there.
using CellSide = std::uint64_t;
/// Sets the sides of a flat box of the facets that are given as sides of cells, one per facet. Others of the
/// `sides` are ignored.
void mark_facet_sides(const std::vector<CellSide>& facets,
                      const std::vector<std::pair<CellSide, std::uint8_t>>& sides, Mesh& mesh);

/// The array in which podm writes the sides of facets.
inline constexpr const char* kSideArray = "box_side";
/// True if readers of VTK's formats keep the cell array: podm's arrays of facets and arrays of labels.
bool is_kept_cell_array(std::string_view name);

/// Returns the word with its ASCII letters in capitals.
std::string upper(std::string_view word);

/// The array in which podm writes label colours: value, red, green and blue of each label.
inline constexpr const char* kColourArray = "label_colours";
/// Reads this array. Throws InputError at `place` if its numbers are of another kind.
void read_label_colours(const MeshFile& file, const std::string& place, const NumberArray& numbers,
                        Mesh& mesh);

/// Returns the rest of `text` after `prefix`; none if `text` does not begin with it.
std::optional<std::string_view> after_prefix(std::string_view text, std::string_view prefix);

/// Removes the leading integer and the blank after it, if any, from `text` and returns the integer. Returns
/// none, and leaves `text` as it is, if no integer is there.
std::optional<std::int64_t> take_integer(std::string_view& text);
/// Returns the integer after `prefix`; none if `text` does not begin with both.
std::optional<std::int64_t> integer_after(std::string_view text, std::string_view prefix);
/// Removes two leading integers, likewise.
std::optional<std::array<LabelValue, 2>> take_pair(std::string_view& text);

}  // namespace podm::verify
