// Legacy VTK, version 3.0, binary, big-endian. A cell is the number of its vertices, followed by its
// vertices. Cells and facets go to two files with the same arrays as in VTU. Format: "VTK file formats",
// simple legacy formats.
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <limits>

#include "files/atomic_file.h"
#include "files/big_endian.h"
#include "io/label_table.h"
#include "io/mesh_formats.h"
#include "io/promises.h"
#include "io/vertex_subset.h"
#include "io/write_vtu.h"
#include "podm/errors.h"

namespace podm {
namespace {

constexpr std::int32_t kVtkTriangle = 5, kVtkTetrahedron = 10;

// Encodes an array name as VTK does; an unencoded name would end at a blank.
std::string percent_encoded(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const bool is_plain = c > ' ' && c < 0x7f && c != '"' && c != '%';
    text += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

// Writes one number per array, with the text in the array's name, and the colours of labels, as in VTU.
void put_field_data(const TetMesh& mesh, AtomicFile& file) {
  const LabelNames names(mesh.labels);
  std::vector<std::pair<std::string, std::uint32_t>> arrays{{"space:" + to_string(mesh.space), 1}};
  for (const std::string& promise : promises_of(mesh)) arrays.emplace_back("promise:" + promise, 1);
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    arrays.emplace_back("label:" + names[static_cast<LabelIndex>(i)], mesh.labels[i].value);
  const auto colours = colours_of(mesh.labels);
  file.write(fmt::format("FIELD FieldData {}\n", arrays.size() + (colours.empty() ? 0 : 1)));
  for (const auto& [name, value] : arrays) {
    file.write(fmt::format("{} 1 1 unsigned_int\n", percent_encoded(name)));
    put_big_endian(file, value);
    file.write("\n");
  }
  if (colours.empty()) return;
  file.write(fmt::format("{} 4 {} unsigned_int\n", kColourArray, colours.size()));
  for (const auto& colour : colours) put_big_endian(file, colour);
  file.write("\n");
}

void put_head(const TetMesh& mesh, AtomicFile& file) {
  file.write("# vtk DataFile Version 3.0\ntetrahedral mesh of labels\nBINARY\nDATASET UNSTRUCTURED_GRID\n");
  put_field_data(mesh, file);
}

// `vertex_of(i, k)` is the k-th of the N vertices of cell i.
template <std::size_t N, class VertexOf>
void put_cells(std::size_t count, std::int32_t type, VertexOf vertex_of, AtomicFile& file) {
  file.write(fmt::format("\nCELLS {} {}\n", count, (N + 1) * count));
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::int32_t, N + 1> cell{N};
    for (std::size_t k = 0; k < N; ++k) cell[k + 1] = static_cast<std::int32_t>(vertex_of(i, k));
    put_big_endian(file, cell);
  }
  file.write(fmt::format("\nCELL_TYPES {}\n", count));
  for (std::size_t i = 0; i < count; ++i) put_big_endian(file, type);
}

template <class ValueAt>
void put_scalars(const char* name, std::size_t count, ValueAt value_at, AtomicFile& file) {
  file.write(fmt::format("\nSCALARS {} unsigned_int\nLOOKUP_TABLE default\n", name));
  for (std::size_t i = 0; i < count; ++i) put_big_endian(file, std::uint32_t{value_at(i)});
}

void write_cells(const TetMesh& mesh, AtomicFile& file) {
  put_head(mesh, file);
  file.write(fmt::format("POINTS {} double\n", mesh.vertices.size()));
  for (const auto& vertex : mesh.vertices) put_big_endian(file, vertex);
  put_cells<4>(
      mesh.cells.size(), kVtkTetrahedron, [&](std::size_t i, std::size_t k) { return mesh.cells[i][k]; },
      file);
  file.write(fmt::format("\nCELL_DATA {}", mesh.cells.size()));
  put_scalars(
      "label", mesh.cells.size(), [&](std::size_t i) { return mesh.labels[mesh.cell_labels[i]].value; },
      file);
  file.write("\n");
}

void write_facets(const TetMesh& mesh, AtomicFile& file) {
  VertexSubset subset(mesh.vertices.size());
  subset.assign(mesh.facets);
  put_head(mesh, file);
  file.write(fmt::format("POINTS {} double\n", subset.vertices().size()));
  for (const std::uint32_t vertex : subset.vertices()) put_big_endian(file, mesh.vertices[vertex]);
  put_cells<3>(
      mesh.facets.size(), kVtkTriangle,
      [&](std::size_t i, std::size_t k) { return subset.position(mesh.facets[i][k]); }, file);
  file.write(fmt::format("\nCELL_DATA {}", mesh.facets.size()));
  for (const int side : {0, 1}) {
    put_scalars(
        side == 0 ? "label_a" : "label_b", mesh.facets.size(),
        [&](std::size_t i) { return mesh.labels[mesh.facet_labels[i][side]].value; }, file);
  }
  if (mesh.is_box_flat)
    put_scalars(
        kBoxSideArray, mesh.facets.size(), [&](std::size_t i) { return side_number_of_facet(mesh, i); },
        file);
  file.write(fmt::format("\nPOINT_DATA {}", subset.vertices().size()));
  put_scalars(
      "vertex", subset.vertices().size(), [&](std::size_t i) { return subset.vertices()[i]; }, file);
  file.write("\n");
}

}  // namespace

void write_legacy_vtk(const TetMesh& mesh, const std::string& path) {
  if (mesh.vertices.size() > std::size_t{std::numeric_limits<std::int32_t>::max()})
    throw InputError(fmt::format("cannot write {}: legacy VTK supports at most 2^31 vertices", path));
  std::deque<AtomicFile> files;
  files.emplace_back(path);
  files.emplace_back(facets_path_of(path));
  write_cells(mesh, files[0]);
  write_facets(mesh, files[1]);
  publish_together(files);
}

}  // namespace podm
