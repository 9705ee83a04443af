// VTK XML unstructured grids (.vtu).
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "readers/formats.h"
#include "readers/mesh_parts.h"
#include "readers/vtk_cells.h"
#include "readers/vtu_document.h"
#include "readers/vtu_grid.h"

namespace podm::verify {
namespace {

std::string piece_place(const VtuPiece& piece) { return fmt::format("line {}, Piece", piece.line); }

const VtuArray* find_array(const std::vector<VtuArray>& arrays, const std::string& name) {
  const auto found =
      std::find_if(arrays.begin(), arrays.end(), [&](const VtuArray& array) { return array.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

const VtuArray& need_array(const MeshFile& file, const VtuPiece& piece, const std::vector<VtuArray>& arrays,
                           const std::string& name) {
  const VtuArray* array = find_array(arrays, name);
  if (array == nullptr) file.refuse(piece_place(piece), fmt::format("no DataArray '{}'", name));
  return *array;
}

VtkPiece load_piece(const MeshFile& file, VtuDocument& document, const VtuPiece& piece) {
  VtkPiece loaded;
  loaded.place = piece_place(piece);
  check_counts(file, loaded.place, piece.num_points, piece.num_cells);
  const auto load = [&](const VtuArray& array, std::optional<std::uint64_t> count) {
    return load_vtu_array(file, document, array, count);
  };
  if (!piece.points.empty())
    loaded.points = load(piece.points.front(), 3 * piece.num_points);
  else if (piece.num_points > 0)
    file.refuse(loaded.place, "no DataArray in Points");
  if (piece.num_cells == 0) return loaded;
  loaded.types = load(need_array(file, piece, piece.cells, "types"), piece.num_cells);
  loaded.offsets = load(need_array(file, piece, piece.cells, "offsets"), piece.num_cells);
  loaded.connectivity = load(need_array(file, piece, piece.cells, "connectivity"), std::nullopt);
  for (const VtuArray& array : piece.cell_data)
    loaded.cell_data.push_back({array.name, array.num_components, load(array, std::nullopt)});
  return loaded;
}

// Reads the arrays that podm writes: "space:RAS", "promise:unclaimed delaunay" and "label:liver", whose value
// is the label's, and the colours of labels.
void read_field_data(const MeshFile& file, VtuDocument& document, Mesh& mesh) {
  for (const VtuArray& array : document.field_data) {
    if (read_note(file, array.place(), array.name, mesh, ':')) continue;
    if (const auto name = after_prefix(array.name, "label:")) {
      const NumberArray values = load_vtu_array(file, document, array, std::nullopt);
      const auto value = values.size() == 1 ? values.integer(0) : std::nullopt;
      if (!value) file.refuse(array.place(), "not one integer, the value of the label");
      mesh.label_names[*value] = *name;
    } else if (array.name == kColourArray) {
      read_label_colours(file, array.place(), load_vtu_array(file, document, array, std::nullopt), mesh);
    }
  }
}

std::string describe(const VtuDocument& document) {
  std::string text = "VTU";
  if (document.pieces.empty() || document.pieces.front().points.empty()) return text;
  switch (document.pieces.front().points.front().format) {
    case VtuArray::Format::kAscii:
      return text + ", ascii";
    case VtuArray::Format::kInlineBase64:
      text += ", inline base64";
      break;
    case VtuArray::Format::kAppended:
      text += document.is_appended_base64 ? ", appended base64" : ", appended raw";
  }
  if (document.is_zlib) text += ", zlib";
  return text + (document.is_big_endian ? ", big endian" : "");
}

void assemble(const MeshFile& file, VtuDocument& document, Mesh& mesh) {
  VtkAssembler assembler(file, mesh);
  for (const VtuPiece& piece : document.pieces)
    assembler.append(load_piece(file, document, piece), document.pieces.size() == 1);
}

// Reads the ids of every piece in the file's order, the order in which the assembler appends points.
void read_point_ids(const MeshFile& file, VtuDocument& document, const char* name, VtuGrid& grid) {
  for (const VtuPiece& piece : document.pieces) {
    if (piece.num_points == 0) continue;
    const VtuArray& array = need_array(file, piece, piece.point_data, name);
    const NumberArray ids = load_vtu_array(file, document, array, piece.num_points);
    make_room(grid.point_ids, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) grid.point_ids.push_back(global_id(ids.integer(i)));
    grid.ids_place = array.place();
  }
}

template <std::size_t N>
void append_corners(const std::vector<std::array<VertexId, N>>& corners,
                    const std::vector<VertexId>& vertex_of, std::vector<std::array<VertexId, N>>& all) {
  make_room(all, corners.size());
  for (std::array<VertexId, N> ids : corners) {
    for (VertexId& id : ids) id = id < vertex_of.size() ? vertex_of[id] : kNone;
    all.push_back(ids);
  }
}

template <class Label>
void append_labels(const std::vector<Label>& labels, std::vector<Label>& all) {
  make_room(all, labels.size());
  all.insert(all.end(), labels.begin(), labels.end());
}

}  // namespace

VtuGrid read_vtu_grid(const MeshFile& file, const char* id_array) {
  VtuDocument document = parse_vtu(file);
  VtuGrid grid;
  grid.mesh.format = describe(document);
  read_field_data(file, document, grid.mesh);
  assemble(file, document, grid.mesh);
  if (id_array != nullptr) read_point_ids(file, document, id_array, grid);
  return grid;
}

std::uint64_t count_vtu_points(const MeshFile& file) {
  VtuDocument document = parse_vtu(file);
  std::uint64_t count = 0;
  for (const VtuPiece& piece : document.pieces) {
    check_counts(file, piece_place(piece), piece.num_points, piece.num_cells);
    if (piece.points.empty()) continue;
    load_vtu_array(file, document, piece.points.front(), 3 * piece.num_points);
    count += piece.num_points;
  }
  return count;
}

std::vector<VertexId> vertex_ids(const VtuGrid& grid) {
  std::vector<VertexId> ids;
  ids.reserve(grid.point_ids.size());
  for (const GlobalId id : grid.point_ids)
    ids.push_back(static_cast<VertexId>(std::min<GlobalId>(id, kNone)));
  return ids;
}

bool is_same_point(const Point& a, const Point& b) {
  using Bits = std::array<std::uint64_t, 3>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

void check_points(const MeshFile& file, const VtuGrid& grid, const Mesh& mesh) {
  for (std::size_t i = 0; i < grid.point_ids.size(); ++i) {
    const GlobalId vertex = grid.point_ids[i];
    if (vertex < mesh.vertices.size() && is_same_point(mesh.vertices[vertex], grid.mesh.vertices[i]))
      continue;
    file.refuse(
        grid.ids_place,
        fmt::format("point {} is not at a vertex of {}: the files do not belong together", i, mesh.path));
  }
}

void append_cells(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                  Mesh& mesh) {
  if (grid.mesh.cells.empty()) return;
  check_counts(file, "CellData", mesh.vertices.size(), mesh.cells.size() + grid.mesh.cells.size());
  if (mesh.cells.empty()) mesh.cell_label_array = grid.mesh.cell_label_array;
  if (grid.mesh.cell_label_array != mesh.cell_label_array) {
    file.refuse("CellData", fmt::format("cell labels in array '{}', in the pieces before in '{}'",
                                        grid.mesh.cell_label_array, mesh.cell_label_array));
  }
  append_corners(grid.mesh.cells, vertex_of, mesh.cells);
  append_labels(grid.mesh.cell_labels, mesh.cell_labels);
}

void append_facets(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                   Mesh& mesh) {
  if (grid.mesh.facets.empty()) return;
  if (!mesh.facets.empty() && mesh.facet_labels.empty() != grid.mesh.facet_labels.empty())
    file.refuse("CellData", "label_a and label_b are missing in a piece that has triangles");
  const bool has_sides = !mesh.facet_sides.empty() || !grid.mesh.facet_sides.empty();
  if (has_sides) mesh.facet_sides.resize(mesh.facets.size());
  append_corners(grid.mesh.facets, vertex_of, mesh.facets);
  append_labels(grid.mesh.facet_labels, mesh.facet_labels);
  append_labels(grid.mesh.facet_sides, mesh.facet_sides);
  if (has_sides) mesh.facet_sides.resize(mesh.facets.size());
}

Mesh read_vtu(const MeshFile& file) { return read_vtu_grid(file, nullptr).mesh; }

void read_vtu_facets(const MeshFile& file, Mesh& mesh) {
  VtuGrid surface = read_vtu_grid(file, "vertex");
  check_points(file, surface, mesh);
  append_facets(file, surface, vertex_ids(surface), mesh);
}

}  // namespace podm::verify
