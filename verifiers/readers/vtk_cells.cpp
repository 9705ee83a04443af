#include "readers/vtk_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

constexpr std::int64_t kTriangle = 5, kTetrahedron = 10, kQuadraticTriangle = 22, kQuadraticTetrahedron = 24;

// VTK's cell types (vtkCellType.h) by their common names.
std::string name_of_type(std::int64_t type) {
  constexpr std::pair<int, const char*> kNames[] = {
      {0, "empty cells"},     {1, "vertices"}, {2, "vertex groups"}, {3, "lines"},          {4, "polylines"},
      {6, "triangle strips"}, {7, "polygons"}, {8, "pixels"},        {9, "quadrilaterals"}, {11, "voxels"},
      {12, "hexahedra"},      {13, "wedges"},  {14, "pyramids"},     {42, "polyhedra"}};
  for (const auto& [known, name] : kNames)
    if (type == known) return name;
  return fmt::format("cells of VTK type {}", type);
}

const NamedArray* find_array(const VtkPiece& piece, const std::string& name) {
  const auto found = std::find_if(piece.cell_data.begin(), piece.cell_data.end(),
                                  [&](const NamedArray& array) { return array.name == name; });
  return found == piece.cell_data.end() ? nullptr : &*found;
}

// Labels are an array with a name of the list and one integer per cell.
bool holds_labels(const NamedArray& array, std::size_t num_cells) {
  if (!label_array_rank(array.name) || array.num_components != 1 || array.values.size() != num_cells)
    return false;
  for (std::size_t i = 0; i < num_cells; ++i)
    if (!array.values.integer(i)) return false;
  return true;
}

const NamedArray* most_usual_labels(const VtkPiece& piece) {
  const NamedArray* best = nullptr;
  for (const NamedArray& array : piece.cell_data) {
    if (!holds_labels(array, piece.types.size())) continue;
    if (best == nullptr || label_array_rank(array.name) < label_array_rank(best->name)) best = &array;
  }
  return best;
}

}  // namespace

void VtkAssembler::append(const VtkPiece& piece, bool is_only) {
  const std::size_t num_points = piece.points.size() / 3, num_cells = piece.types.size();
  check_counts(file_, piece.place, mesh_.vertices.size() + num_points, mesh_.cells.size() + num_cells);
  base_ = static_cast<VertexId>(mesh_.vertices.size());
  id_limit_ = is_only ? std::numeric_limits<std::uint64_t>::max() : num_points;
  append_points(piece);
  append_cells(piece);
  if (!cells_.empty()) append_cell_labels(piece);
  if (!facets_.empty()) append_facet_labels(piece);
  if (!facets_.empty()) append_facet_sides(piece);
}

void VtkAssembler::append_points(const VtkPiece& piece) {
  const std::size_t num_points = piece.points.size() / 3;
  make_room(mesh_.vertices, num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    mesh_.vertices.push_back(
        {piece.points.real(3 * i), piece.points.real(3 * i + 1), piece.points.real(3 * i + 2)});
  }
}

void VtkAssembler::append_cells(const VtkPiece& piece) {
  cells_.clear();
  facets_.clear();
  const std::size_t num_cells = piece.types.size();
  std::size_t end = 0;
  for (std::size_t cell = 0; cell < num_cells; ++cell) {
    const Range ids = ids_of(piece, cell, end);
    end = ids.end;
    const auto type = piece.types.integer(cell).value_or(-1);
    if (type == kTetrahedron || type == kQuadraticTetrahedron) {
      if (mesh_.cells.size() == mesh_.cells.capacity()) make_room(mesh_.cells, num_cells - cell);
      mesh_.cells.push_back(corners<4>(piece, cell, ids, type == kTetrahedron ? 4 : 10));
      cells_.push_back(cell);
      if (type == kQuadraticTetrahedron) ++mesh_.other_cells[kQuadraticTetrahedra];
    } else if (type == kTriangle || type == kQuadraticTriangle) {
      mesh_.facets.push_back(corners<3>(piece, cell, ids, type == kTriangle ? 3 : 6));
      facets_.push_back(cell);
      if (type == kQuadraticTriangle) ++mesh_.other_cells[kQuadraticTriangles];
    } else {
      ++mesh_.other_cells[name_of_type(type)];
    }
  }
}

VtkAssembler::Range VtkAssembler::ids_of(const VtkPiece& piece, std::size_t cell, std::size_t end) const {
  const std::size_t size = piece.connectivity.size();
  if (piece.layout == CellLayout::kInterleaved) {
    const auto count = end < size ? piece.connectivity.integer(end).value_or(-1) : -1;
    if (count < 0 || static_cast<std::uint64_t>(count) > size - end - 1)
      refuse(piece, fmt::format("cell {}: its points run past the end of the list of cells", cell));
    return {end + 1, end + 1 + static_cast<std::size_t>(count)};
  }
  const std::size_t skipped = piece.layout == CellLayout::kStarts ? 1 : 0;
  const auto next = piece.offsets.integer(cell + skipped).value_or(-1);
  if (next < static_cast<std::int64_t>(end) || static_cast<std::uint64_t>(next) > size) {
    refuse(piece, fmt::format("cell {}: its points in connectivity would be [{}, {}) of {} values", cell, end,
                              next, size));
  }
  return {end, static_cast<std::size_t>(next)};
}

template <std::size_t N>
std::array<VertexId, N> VtkAssembler::corners(const VtkPiece& piece, std::size_t cell, const Range& ids,
                                              std::size_t num_ids) const {
  if (ids.end - ids.begin != num_ids) {
    refuse(piece, fmt::format("cell {}: {} points, its type has {}", cell, ids.end - ids.begin, num_ids));
  }
  std::array<VertexId, N> corners;
  for (std::size_t i = 0; i < N; ++i) {
    const VertexId id = vertex_id(piece.connectivity.integer(ids.begin + i));
    corners[i] = id == kNone || id >= id_limit_ ? kNone : base_ + id;
  }
  return corners;
}

// The first piece with tetrahedra chooses the array; the other pieces must have it too.
void VtkAssembler::append_cell_labels(const VtkPiece& piece) {
  const bool is_first = mesh_.cells.size() == cells_.size();
  const NamedArray* labels = is_first ? most_usual_labels(piece) : find_array(piece, mesh_.cell_label_array);
  if (is_first && labels != nullptr) mesh_.cell_label_array = labels->name;
  if (mesh_.cell_label_array.empty()) return;
  if (labels == nullptr || !holds_labels(*labels, piece.types.size()))
    refuse(piece, fmt::format("no cell array '{}' of one integer per cell", mesh_.cell_label_array));
  make_room(mesh_.cell_labels, cells_.size());
  for (const std::size_t cell : cells_) mesh_.cell_labels.push_back(*labels->values.integer(cell));
}

void VtkAssembler::append_facet_labels(const VtkPiece& piece) {
  const NamedArray* const sides[] = {find_array(piece, "label_a"), find_array(piece, "label_b")};
  if (sides[0] == nullptr && sides[1] == nullptr && mesh_.facet_labels.empty()) return;
  for (const NamedArray* side : sides) {
    if (side == nullptr || side->num_components != 1 || side->values.size() != piece.types.size())
      refuse(piece, "triangles need both arrays, label_a and label_b, of one integer per cell");
  }
  if (mesh_.facet_labels.size() + facets_.size() != mesh_.facets.size())
    refuse(piece, "label_a and label_b are in this piece and not in an earlier one");
  for (const std::size_t cell : facets_) {
    const auto a = sides[0]->values.integer(cell), b = sides[1]->values.integer(cell);
    if (!a || !b) refuse(piece, fmt::format("cell {}: label_a or label_b is not an integer", cell));
    mesh_.facet_labels.push_back({*a, *b});
  }
}

// Facets of pieces without the array are on no side.
void VtkAssembler::append_facet_sides(const VtkPiece& piece) {
  const NamedArray* const sides = find_array(piece, kSideArray);
  if (sides == nullptr) {
    if (!mesh_.facet_sides.empty()) mesh_.facet_sides.resize(mesh_.facets.size());
    return;
  }
  if (sides->num_components != 1 || sides->values.size() != piece.types.size())
    refuse(piece, fmt::format("the array {} is not of one integer per cell", kSideArray));
  mesh_.facet_sides.resize(mesh_.facets.size() - facets_.size());
  for (const std::size_t cell : facets_) {
    const std::int64_t side = sides->values.integer(cell).value_or(-1);
    if (side < 0 || side > 6) refuse(piece, fmt::format("cell {}: {} is not 0 to 6", cell, kSideArray));
    mesh_.facet_sides.push_back(static_cast<std::uint8_t>(side));
  }
}

void VtkAssembler::refuse(const VtkPiece& piece, const std::string& fault) const {
  file_.refuse(piece.place, fault);
}

}  // namespace podm::verify
