// VTK XML unstructured grids with appended raw binary data.
//
// An XML head declares the arrays and their places in the binary tail. An array in the tail is its size in
// bytes (UInt64) and its values. Cells and facets go to two files, because readers of tetrahedra (FEniCS,
// PyVista filters, solvers) fail on grids of mixed dimension.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <filesystem>
#include <functional>
#include <limits>
#include <system_error>

#include "files/atomic_file.h"
#include "io/label_table.h"
#include "io/mesh_formats.h"
#include "io/promises.h"
#include "io/vertex_subset.h"
#include "io/write_vtu.h"
#include "io/xml_text.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little, "the files declare little-endian data");

constexpr int kVtkLine = 3, kVtkTriangle = 5, kVtkTetrahedron = 10;

struct VtuArray {
  std::string declaration;  // all attributes except the offset
  std::uint64_t bytes;
  std::function<void(AtomicFile&)> write;
};

std::string declaration(const std::string& type, const std::string& name, int components) {
  return fmt::format(R"(type="{}" Name="{}" NumberOfComponents="{}")", type, name, components);
}

// Makes an array from `value_at(i)` for i in [0, count), of C++ type Value. VTK reads it as `components`
// numbers of type `type`.
template <class Value, class ValueAt>
VtuArray make_array(const std::string& type, const std::string& name, std::size_t count, ValueAt value_at,
                    int components = 1) {
  return {declaration(type, name, components), count * sizeof(Value), [count, value_at](AtomicFile& file) {
            std::array<Value, 4096> block;
            for (std::size_t begin = 0; begin < count; begin += block.size()) {
              const std::size_t size = std::min(block.size(), count - begin);
              for (std::size_t i = 0; i < size; ++i) block[i] = static_cast<Value>(value_at(begin + i));
              file.write(block.data(), size * sizeof(Value));
            }
          }};
}

// Makes an array from values that have VTK's layout in memory.
template <class Value>
VtuArray make_array_of(const std::string& type, const std::string& name, const std::vector<Value>& values,
                       int components = 1) {
  return {declaration(type, name, components), values.size() * sizeof(Value),
          [&values](AtomicFile& file) { file.write(values.data(), values.size() * sizeof(Value)); }};
}

// Returns true if ids need Int64. Int32 halves the file.
bool is_wide(std::size_t largest) { return largest > std::numeric_limits<std::int32_t>::max(); }
template <class ValueAt>
VtuArray make_id_array(const std::string& name, std::size_t count, bool wide, ValueAt value_at) {
  return wide ? make_array<std::int64_t>("Int64", name, count, value_at)
              : make_array<std::int32_t>("Int32", name, count, value_at);
}

struct VtuGrid {
  std::size_t num_points = 0, num_cells = 0;
  std::string point_attributes;                                // attributes of point arrays for VTK
  std::vector<VtuArray> point_data, cell_data, points, cells;  // the sections, in the file's order
};

void add_cells(std::size_t count, int vertices_per_cell, int cell_type, bool wide, VtuArray connectivity,
               VtuGrid& grid) {
  grid.num_cells = count;
  grid.cells.push_back(std::move(connectivity));
  grid.cells.push_back(make_id_array("offsets", count, wide, [vertices_per_cell](std::size_t i) {
    return (i + 1) * static_cast<std::size_t>(vertices_per_cell);
  }));
  grid.cells.push_back(
      make_array<std::uint8_t>("UInt8", "types", count, [cell_type](std::size_t) { return cell_type; }));
}

// VTK also has string arrays, but meshio refuses files with them. A number has its text as its name.
std::string field_array(const std::string& name, std::uint32_t value) {
  return fmt::format(R"(<DataArray type="UInt32" Name="{}" NumberOfTuples="1" format="ascii">{}</DataArray>)"
                     "\n",
                     xml_escaped(name), value);
}

// Returns the space, the promises, the names of labels, `more` arrays, and the colours of labels.
std::string field_data(const TetMesh& mesh, const std::string& more = {}) {
  const LabelNames names(mesh.labels);
  std::string text = "<FieldData>\n" + field_array("space:" + to_string(mesh.space), 1);
  for (const std::string& promise : promises_of(mesh)) text += field_array("promise:" + promise, 1);
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    text += field_array("label:" + names[static_cast<LabelIndex>(i)], mesh.labels[i].value);
  text += more;
  if (const auto colours = colours_of(mesh.labels); !colours.empty()) {
    text += fmt::format(
        R"(<DataArray type="UInt32" Name="{}" NumberOfComponents="4" NumberOfTuples="{}" format="ascii">)",
        kColourArray, colours.size());
    for (const auto& colour : colours) text += fmt::format("{}\n", fmt::join(colour, " "));
    text += "</DataArray>\n";
  }
  return text + "</FieldData>\n";
}

void write_grid(AtomicFile& file, const VtuGrid& grid, const std::string& field_data) {
  file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n");
  file.write(field_data);
  file.write(
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", grid.num_points, grid.num_cells));
  std::uint64_t offset = 0;
  const auto declare = [&](const std::string& section, const std::vector<VtuArray>& arrays,
                           const std::string& attributes = {}) {
    file.write("<" + section + attributes + ">\n");
    for (const VtuArray& array : arrays) {
      file.write(
          fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", array.declaration, offset));
      offset += sizeof(array.bytes) + array.bytes;
    }
    file.write("</" + section + ">\n");
  };
  declare("PointData", grid.point_data, grid.point_attributes);
  declare("CellData", grid.cell_data);
  declare("Points", grid.points);
  declare("Cells", grid.cells);
  file.write("</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
  for (const auto* section : {&grid.point_data, &grid.cell_data, &grid.points, &grid.cells}) {
    for (const VtuArray& array : *section) {
      file.put(array.bytes);
      array.write(file);
    }
  }
  file.write("\n</AppendedData>\n</VTKFile>\n");
}

VtuGrid cell_grid(const TetMesh& mesh) {
  const std::size_t num_corners = 4 * mesh.cells.size();
  const bool wide = is_wide(std::max(mesh.vertices.size(), num_corners));
  VtuGrid grid;
  grid.num_points = mesh.vertices.size();
  grid.points.push_back(make_array_of("Float64", "Points", mesh.vertices, 3));
  add_cells(mesh.cells.size(), 4, kVtkTetrahedron, wide,
            wide ? make_array<std::int64_t>("Int64", "connectivity", num_corners,
                                            [&mesh](std::size_t i) { return mesh.cells[i / 4][i % 4]; })
                 : make_array_of("Int32", "connectivity", mesh.cells),
            grid);
  grid.cell_data.push_back(
      make_array<std::uint32_t>("UInt32", "label", mesh.cells.size(),
                                [&mesh](std::size_t i) { return mesh.labels[mesh.cell_labels[i]].value; }));
  for (const CellArray& array : mesh.cell_arrays)
    grid.cell_data.push_back(make_array_of("Float64", xml_escaped(array.name), array.values));
  return grid;
}

VtuGrid facet_grid(const TetMesh& mesh, const VertexSubset& subset) {
  const std::size_t num_corners = 3 * mesh.facets.size();
  const bool wide = is_wide(std::max(subset.vertices().size(), num_corners));
  VtuGrid grid;
  grid.num_points = subset.vertices().size();
  grid.points.push_back(make_array<std::array<double, 3>>(
      "Float64", "Points", grid.num_points,
      [&mesh, &subset](std::size_t i) { return mesh.vertices[subset.vertices()[i]]; }, 3));
  add_cells(
      mesh.facets.size(), 3, kVtkTriangle, wide,
      make_id_array("connectivity", num_corners, wide,
                    [&mesh, &subset](std::size_t i) { return subset.position(mesh.facets[i / 3][i % 3]); }),
      grid);
  grid.point_data.push_back(make_array_of("UInt32", "vertex", subset.vertices()));
  for (const int side : {0, 1}) {
    grid.cell_data.push_back(make_array<std::uint32_t>(
        "UInt32", side == 0 ? "label_a" : "label_b", mesh.facets.size(),
        [&mesh, side](std::size_t i) { return mesh.labels[mesh.facet_labels[i][side]].value; }));
  }
  if (mesh.is_box_flat)
    grid.cell_data.push_back(
        make_array<std::uint8_t>("UInt8", kBoxSideArray, mesh.facets.size(),
                                 [&mesh](std::size_t i) { return side_number_of_facet(mesh, i); }));
  return grid;
}

VtuGrid line_grid(const TetMesh& mesh, const VertexSubset& subset) {
  const auto& edges = mesh.lines.edges;
  VtuGrid grid;
  grid.num_points = subset.vertices().size();
  grid.points.push_back(make_array<std::array<double, 3>>(
      "Float64", "Points", grid.num_points,
      [&mesh, &subset](std::size_t i) { return mesh.vertices[subset.vertices()[i]]; }, 3));
  const std::size_t num_ends = 2 * edges.size();
  const bool wide = is_wide(std::max(grid.num_points, num_ends));
  add_cells(edges.size(), 2, kVtkLine, wide,
            make_id_array("connectivity", num_ends, wide,
                          [&edges, &subset](std::size_t i) { return subset.position(edges[i / 2][i % 2]); }),
            grid);
  grid.point_data.push_back(make_array_of("UInt32", "vertex", subset.vertices()));
  grid.cell_data.push_back(make_array_of("UInt32", "line", mesh.lines.line_of_edge));
  return grid;
}

// The name of each line holds its number.
std::string line_names(const TetMesh& mesh) {
  const LabelNames names(mesh.labels);
  std::string text;
  for (std::size_t line = 0; line < mesh.lines.labels_of_line.size(); ++line)
    text += field_array("line:" + names.of_line(mesh.lines.labels_of_line[line]),
                        static_cast<std::uint32_t>(line));
  return text;
}

// Adds the number of each point in the whole mesh, under the name that VTK's filters use.
template <class IdAt>
void add_global_ids(std::size_t num_points, IdAt id_at, VtuGrid& grid) {
  grid.point_attributes = fmt::format(" GlobalIds=\"{}\"", kGlobalIds);
  grid.point_data.push_back(make_array<std::int64_t>("Int64", kGlobalIds, num_points, id_at));
}

std::string path_of_part(const std::string& path, const char* part) {
  const std::filesystem::path cells(path);
  return (cells.parent_path() / (cells.stem().string() + part + cells.extension().string())).string();
}

}  // namespace

std::string facets_path_of(const std::string& path) { return path_of_part(path, "_facets"); }
std::string lines_path_of(const std::string& path) { return path_of_part(path, "_lines"); }

std::deque<AtomicFile> write_vtu_aside(const TetMesh& mesh, const std::vector<std::uint64_t>* vertex_ids,
                                       const std::string& path) {
  std::deque<AtomicFile> files;
  files.emplace_back(path);
  files.emplace_back(facets_path_of(path));
  const std::string labels_and_space = field_data(mesh);

  VtuGrid cells = cell_grid(mesh);
  if (vertex_ids)
    add_global_ids(
        cells.num_points, [=](std::size_t i) { return (*vertex_ids)[i]; }, cells);
  write_grid(files[0], cells, labels_and_space);

  VertexSubset subset(mesh.vertices.size());
  subset.assign(mesh.facets);
  VtuGrid facets = facet_grid(mesh, subset);
  if (vertex_ids) {
    const auto id_at = [&](std::size_t i) { return (*vertex_ids)[subset.vertices()[i]]; };
    add_global_ids(facets.num_points, id_at, facets);
  }
  write_grid(files[1], facets, labels_and_space);
  if (!mesh.lines.are_kept()) return files;
  files.emplace_back(lines_path_of(path));
  subset.assign(mesh.lines.edges);
  write_grid(files[2], line_grid(mesh, subset), field_data(mesh, line_names(mesh)));
  return files;
}

Losses write_vtu(const TetMesh& mesh, const std::string& path) {
  std::deque<AtomicFile> files = write_vtu_aside(mesh, nullptr, path);
  publish_together(files);
  const std::filesystem::path lines = lines_path_of(path);
  std::error_code ignored;  // the mesh is written
  if (mesh.lines.are_kept() || !std::filesystem::exists(lines, ignored)) return {};
  return {fmt::format("{} beside it is of another mesh", lines.filename().string())};
}

}  // namespace podm
