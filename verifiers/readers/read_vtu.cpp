// VTK XML unstructured grids (.vtu).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "readers/formats.h"
#include "readers/mesh_parts.h"
#include "readers/vtk_cells.h"
#include "readers/vtu_document.h"

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

// Our mesher's words: arrays "space:RAS" and "label:liver", the latter with the label's value.
void read_field_data(const MeshFile& file, VtuDocument& document, Mesh& mesh) {
  for (const VtuArray& array : document.field_data) {
    if (const auto word = after_prefix(array.name, "space:")) {
      if (const auto space = space_of(*word)) mesh.space = *space;
    } else if (const auto name = after_prefix(array.name, "label:")) {
      const NumberArray values = load_vtu_array(file, document, array, std::nullopt);
      const auto value = values.size() == 1 ? values.integer(0) : std::nullopt;
      if (!value) file.refuse(array.place(), "not one integer, the value of the label");
      mesh.label_names[*value] = *name;
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

// The vertices of the mesh that the facets' own points are; one that is elsewhere shows that the two files do
// not belong together.
std::vector<VertexId> match_points(const MeshFile& file, VtuDocument& document,
                                   const std::vector<Point>& points, const Mesh& mesh) {
  std::vector<VertexId> vertices;
  for (const VtuPiece& piece : document.pieces) {
    if (piece.num_points == 0) continue;
    const VtuArray& array = need_array(file, piece, piece.point_data, "vertex");
    const NumberArray ids = load_vtu_array(file, document, array, piece.num_points);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const VertexId vertex = vertex_id(ids.integer(i));
      using Bits = std::array<std::uint64_t, 3>;  // equal even where coordinates are NaN
      if (vertex >= mesh.vertices.size() ||
          std::bit_cast<Bits>(mesh.vertices[vertex]) != std::bit_cast<Bits>(points[vertices.size()])) {
        file.refuse(array.place(),
                    fmt::format("point {} is not at a vertex of {}: the files do not belong together",
                                vertices.size(), mesh.path));
      }
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

}  // namespace

Mesh read_vtu(const MeshFile& file) {
  VtuDocument document = parse_vtu(file);
  Mesh mesh;
  mesh.format = describe(document);
  read_field_data(file, document, mesh);
  assemble(file, document, mesh);
  return mesh;
}

void read_vtu_facets(const MeshFile& file, Mesh& mesh) {
  VtuDocument document = parse_vtu(file);
  Mesh surface;
  assemble(file, document, surface);
  const std::vector<VertexId> vertices = match_points(file, document, surface.vertices, mesh);
  mesh.facets = std::move(surface.facets);
  for (auto& facet : mesh.facets)
    for (VertexId& vertex : facet) vertex = vertex < vertices.size() ? vertices[vertex] : kNone;
  mesh.facet_labels = std::move(surface.facet_labels);
}

}  // namespace podm::verify
