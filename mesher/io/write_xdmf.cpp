#include "io/write_xdmf.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "io/hdf5_file.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"
#include "io/xml_text.h"

namespace podm {
namespace {

constexpr std::uint64_t kMostInt32 = std::numeric_limits<std::int32_t>::max();

bool is_wide(const XdmfPart& part) { return part.total_vertices > kMostInt32; }

// Depends only on the table, which all pieces share. It must not depend on the labels that a piece contains.
bool values_are_tags(const TetMesh& mesh) {
  return std::all_of(mesh.labels.begin(), mesh.labels.end(),
                     [](const Label& label) { return label.value <= kMostInt32; });
}

// The vertices that this part writes, sorted by their numbers in the whole mesh.
class WrittenVertices {
 public:
  explicit WrittenVertices(const XdmfPart& part) : part_(part) {
    for (std::size_t v = 0; v < part.mesh.vertices.size(); ++v)
      if (part.owns_vertex == nullptr || (*part.owns_vertex)[v] != 0)
        vertices_.push_back(static_cast<std::uint32_t>(v));
    std::sort(vertices_.begin(), vertices_.end(),
              [this](std::uint32_t a, std::uint32_t b) { return id_of(a) < id_of(b); });
  }

  // Writes each range of consecutive numbers at once; in most cases there is only one range.
  void write(SharedFile& file, const RowsInFile& points) const {
    for (std::size_t begin = 0, end = 0; begin < vertices_.size(); begin = end) {
      const std::uint64_t first = id_of(vertices_[begin]);
      for (end = begin + 1; end < vertices_.size() && id_of(vertices_[end]) == first + (end - begin);) ++end;
      write_rows<double>(file, points, first, end - begin, [&](std::uint64_t row, std::uint64_t axis) {
        return part_.mesh.vertices[vertices_[begin + row]][axis];
      });
    }
  }

 private:
  std::uint64_t id_of(std::uint32_t vertex) const {
    return part_.vertex_ids == nullptr ? vertex : (*part_.vertex_ids)[vertex];
  }

  const XdmfPart& part_;
  std::vector<std::uint32_t> vertices_;
};

// XDMF describes no arrays without rows.
bool has_lines(const TetMesh& mesh) { return !mesh.lines.edges.empty(); }

void write_tables(Hdf5File& file, const TetMesh& mesh, const LabelPairs& pairs) {
  const LabelNames names(mesh.labels);
  std::vector<std::string> label_names, pair_names;
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    label_names.push_back(names[static_cast<LabelIndex>(i)]);
  for (std::size_t i = 0; i < pairs.size(); ++i) pair_names.push_back(names.of_pair(pairs[i]));
  file.make_group("labels");
  file.write_numbers<std::uint32_t>("labels/value", mesh.labels.size(), 0,
                                    [&](std::uint64_t i, std::uint64_t) { return mesh.labels[i].value; });
  file.write_strings("labels/name", label_names);
  file.make_group("pairs");
  file.write_numbers<std::uint32_t>(
      "pairs/labels", pairs.size(), 2,
      [&](std::uint64_t i, std::uint64_t side) { return mesh.labels[pairs[i][side]].value; });
  file.write_strings("pairs/name", pair_names);
  if (mesh.is_box_flat) {
    std::vector<std::string> side_names;
    for (std::size_t side = 0; side < kNumSides; ++side) side_names.push_back(name_of_side(side));
    file.make_group("sides");
    file.write_strings("sides/name", side_names);
  }
  if (!has_lines(mesh)) return;
  std::vector<std::string> line_names;
  for (const auto& labels : mesh.lines.labels_of_line) line_names.push_back(names.of_line(labels));
  file.make_group("line_sets");
  file.write_strings("line_sets/name", line_names);
}

// Writes numbers of vertices as the arrays of `part` have them.
template <class IdAt>
void write_ids(SharedFile& file, const XdmfPart& part, const RowsInFile& to, std::uint64_t first_row,
               std::uint64_t num_rows, const IdAt& id_at) {
  is_wide(part) ? write_rows<std::int64_t>(file, to, first_row, num_rows, id_at)
                : write_rows<std::int32_t>(file, to, first_row, num_rows, id_at);
}

void write_lines(SharedFile& file, const XdmfPart& part, const XdmfArrays& arrays) {
  const MeshLines& lines = part.mesh.lines;
  write_ids(file, part, arrays.lines, 0, lines.edges.size(),
            [&](std::uint64_t i, std::uint64_t end) { return lines.edges[i][end]; });
  write_rows<std::int32_t>(file, arrays.line_tags, 0, lines.edges.size(),
                           [&](std::uint64_t i, std::uint64_t) { return lines.line_of_edge[i] + 1; });
}

std::string data_item(const std::string& file, const char* name, const std::string& sizes, const char* type,
                      int bytes) {
  return fmt::format(
      "<DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}:/{}</DataItem>",
      sizes, type, bytes, xml_escaped(file), name);
}

struct GridOfXdmf {
  const char *name, *topology, *arrays, *attribute, *values;
  std::uint64_t num_cells;
  int vertices_per_cell;
  std::string more = {};  // attributes
};

std::string grid_text(const GridOfXdmf& grid, const XdmfPart& part, const std::string& file) {
  const std::string corners = fmt::format("{} {}", grid.num_cells, grid.vertices_per_cell);
  return fmt::format(
      "<Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\" NodesPerElement=\"{}\">{}</Topology>\n"
      "<Geometry GeometryType=\"XYZ\">{}</Geometry>\n"
      "<Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Cell\">{}</Attribute>\n{}</Grid>\n",
      grid.name, grid.topology, grid.num_cells, grid.vertices_per_cell,
      data_item(file, grid.arrays, corners, "Int", is_wide(part) ? 8 : 4),
      data_item(file, "points", fmt::format("{} 3", part.total_vertices), "Float", 8), grid.attribute,
      data_item(file, grid.values, fmt::format("{}", grid.num_cells), "Int", 4), grid.more);
}

// The number of the side of each facet, from 1; 0: none.
std::string sides_attribute(const XdmfPart& part, const std::string& file) {
  if (!part.mesh.is_box_flat) return "";
  return fmt::format("<Attribute Name=\"side\" AttributeType=\"Scalar\" Center=\"Cell\">{}</Attribute>\n",
                     data_item(file, "facet_sides", fmt::format("{}", part.total_facets), "Int", 4));
}

std::string information(const std::string& name, const std::string& value) {
  return fmt::format("<Information Name=\"{}\" Value=\"{}\"/>\n", name, value);
}

std::string xdmf_text(const std::string& path, const XdmfPart& part) {
  const std::string file = std::filesystem::path(hdf5_path_of(path)).filename().string();
  std::string promises;
  for (const std::string& promise : promises_of(part.mesh)) promises += information("promise", promise);
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n" +
         information("space", to_string(part.mesh.space)) + promises +
         grid_text({"mesh", "Tetrahedron", "cells", "label", "cell_labels", part.total_cells, 4}, part,
                   file) +
         grid_text({"facets", "Triangle", "facets", "pair", "facet_tags", part.total_facets, 3,
                    sides_attribute(part, file)},
                   part, file) +
         (has_lines(part.mesh) ? grid_text({"lines", "PolyLine", "lines", "line", "line_tags",
                                            part.mesh.lines.edges.size(), 2},
                                           part, file)
                               : "") +
         "</Domain>\n</Xdmf>\n";
}

}  // namespace

XdmfPart::XdmfPart(const TetMesh& whole)
    : mesh(whole),
      total_vertices(whole.vertices.size()),
      total_cells(whole.cells.size()),
      total_facets(whole.facets.size()) {}

XdmfPart::XdmfPart(const MeshPiece& piece)
    : mesh(piece.mesh),
      vertex_ids(&piece.vertex_ids),
      owns_vertex(&piece.owns_vertex),
      first_cell(piece.first_cell),
      first_facet(piece.first_facet),
      total_vertices(piece.total_vertices),
      total_cells(piece.total_cells),
      total_facets(piece.total_facets) {}

std::string hdf5_path_of(const std::string& xdmf_path) {
  return std::filesystem::path(xdmf_path).replace_extension(".h5").string();
}

XdmfArrays create_xdmf_arrays(const std::string& file, const std::string& path, const XdmfPart& part,
                              const LabelPairs& pairs) {
  Hdf5File made(file, path);
  const hid_t id_type = is_wide(part) ? H5T_STD_I64LE : H5T_STD_I32LE;
  XdmfArrays arrays;
  arrays.points = made.make_dataset("points", H5T_IEEE_F64LE, part.total_vertices, 3);
  arrays.cells = made.make_dataset("cells", id_type, part.total_cells, 4);
  arrays.cell_labels = made.make_dataset("cell_labels", H5T_STD_I32LE, part.total_cells, 0);
  arrays.facets = made.make_dataset("facets", id_type, part.total_facets, 3);
  arrays.facet_tags = made.make_dataset("facet_tags", H5T_STD_I32LE, part.total_facets, 0);
  arrays.facet_labels = made.make_dataset("facet_labels", H5T_STD_U32LE, part.total_facets, 2);
  if (part.mesh.is_box_flat)
    arrays.facet_sides = made.make_dataset("facet_sides", H5T_STD_I32LE, part.total_facets, 0);
  if (has_lines(part.mesh)) {
    const std::size_t num_edges = part.mesh.lines.edges.size();
    arrays.lines = made.make_dataset("lines", id_type, num_edges, 2);
    arrays.line_tags = made.make_dataset("line_tags", H5T_STD_I32LE, num_edges, 0);
  }
  write_tables(made, part.mesh, pairs);
  made.close();
  return arrays;
}

void write_xdmf_part(const std::string& file, const std::string& path, const XdmfPart& part,
                     const LabelPairs& pairs, const XdmfArrays& arrays) {
  const TetMesh& mesh = part.mesh;
  const auto id_of = [&](std::uint32_t vertex) {
    return part.vertex_ids == nullptr ? vertex : (*part.vertex_ids)[vertex];
  };
  const bool has_values = values_are_tags(mesh);
  SharedFile to(file, path);
  WrittenVertices(part).write(to, arrays.points);
  write_ids(to, part, arrays.cells, part.first_cell, mesh.cells.size(),
            [&](std::uint64_t i, std::uint64_t v) { return id_of(mesh.cells[i][v]); });
  write_rows<std::int32_t>(to, arrays.cell_labels, part.first_cell, mesh.cells.size(),
                           [&](std::uint64_t i, std::uint64_t) {
                             const LabelIndex label = mesh.cell_labels[i];
                             return has_values ? mesh.labels[label].value : label;
                           });
  write_ids(to, part, arrays.facets, part.first_facet, mesh.facets.size(),
            [&](std::uint64_t i, std::uint64_t v) { return id_of(mesh.facets[i][v]); });
  write_rows<std::int32_t>(
      to, arrays.facet_tags, part.first_facet, mesh.facets.size(),
      [&](std::uint64_t i, std::uint64_t) { return pairs.number_of(mesh.facet_labels[i]) + 1; });
  write_rows<std::uint32_t>(
      to, arrays.facet_labels, part.first_facet, mesh.facets.size(),
      [&](std::uint64_t i, std::uint64_t side) { return mesh.labels[mesh.facet_labels[i][side]].value; });
  if (arrays.facet_sides)
    write_rows<std::int32_t>(to, *arrays.facet_sides, part.first_facet, mesh.facets.size(),
                             [&](std::uint64_t i, std::uint64_t) { return side_number_of_facet(mesh, i); });
  if (has_lines(mesh)) write_lines(to, part, arrays);
  to.finish();
}

void publish_xdmf(const std::string& path, const XdmfPart& part, TemporaryFile& arrays) {
  TemporaryFile xdmf(path);
  const std::string text = xdmf_text(path, part);
  xdmf.write(text.data(), text.size());
  TemporaryFile::publish(std::array{&arrays, &xdmf});
}

void write_xdmf(const TetMesh& mesh, const std::string& path) {
  const std::string arrays_path = hdf5_path_of(path);
  const XdmfPart part(mesh);
  const LabelPairs pairs(mesh.facet_labels);
  TemporaryFile file(arrays_path);
  const XdmfArrays arrays = create_xdmf_arrays(file.temporary_path(), arrays_path, part, pairs);
  write_xdmf_part(file.temporary_path(), arrays_path, part, pairs, arrays);
  publish_xdmf(path, part, file);
}

}  // namespace podm
