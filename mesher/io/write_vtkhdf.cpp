#include "io/write_vtkhdf.h"

#include "io/hdf5_file.h"
#include "io/label_table.h"
#include "io/promises.h"
#include "io/write_vtu.h"

namespace podm {
namespace {

constexpr std::uint8_t kVtkTriangle = 5, kVtkTetrahedron = 10;

void write_field_data(Hdf5File& file, const TetMesh& mesh) {
  const LabelNames names(mesh.labels);
  std::vector<std::string> label_names;
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    label_names.push_back(names[static_cast<LabelIndex>(i)]);
  const auto write_texts = [&](const std::string& name, const std::vector<std::string>& texts) {
    file.write_texts_for_vtk("VTKHDF/FieldData/" + name, texts);
  };
  file.make_group("VTKHDF/FieldData");
  write_texts("space", {to_string(mesh.space)});
  if (const auto promises = promises_of(mesh); !promises.empty()) write_texts("promises", promises);
  file.write_numbers<std::uint32_t>("VTKHDF/FieldData/label_value", mesh.labels.size(), 0,
                                    [&](std::uint64_t i, std::uint64_t) { return mesh.labels[i].value; });
  write_texts("label_name", label_names);
  if (const auto colours = colours_of(mesh.labels); !colours.empty())
    file.write_numbers<std::uint32_t>(
        std::string("VTKHDF/FieldData/") + kColourArray, colours.size(), 4,
        [&](std::uint64_t i, std::uint64_t column) { return colours[i][column]; });
}

// Returns the sum of those before `rank`.
VtkhdfSize before(const std::vector<VtkhdfSize>& sizes, std::size_t rank) {
  VtkhdfSize sum;
  for (std::size_t i = 0; i < rank; ++i) {
    sum.points += sizes[i].points;
    sum.cells += sizes[i].cells;
  }
  return sum;
}

}  // namespace

VtkhdfPart::VtkhdfPart(const MeshPiece& piece, Kind kind)
    : piece_(piece), kind_(kind), used_(kind == Kind::kCells ? 0 : piece.mesh.vertices.size()) {
  if (kind == Kind::kCells) {
    size_ = {piece.mesh.vertices.size(), piece.mesh.cells.size()};
  } else {
    used_.assign(piece.mesh.facets);
    size_ = {used_.vertices().size(), piece.mesh.facets.size()};
  }
}

std::uint8_t VtkhdfPart::cell_type() const { return kind_ == Kind::kCells ? kVtkTetrahedron : kVtkTriangle; }

std::vector<std::string> VtkhdfPart::names_of_labels() const {
  if (kind_ == Kind::kCells) return {"label"};
  return {"label_a", "label_b"};
}

std::uint32_t VtkhdfPart::corner(std::size_t cell, std::size_t i) const {
  return kind_ == Kind::kCells ? piece_.mesh.cells[cell][i] : used_.position(piece_.mesh.facets[cell][i]);
}

std::uint32_t VtkhdfPart::label(std::size_t cell, std::size_t side) const {
  const TetMesh& mesh = piece_.mesh;
  return mesh.labels[kind_ == Kind::kCells ? mesh.cell_labels[cell] : mesh.facet_labels[cell][side]].value;
}

VtkhdfArrays create_vtkhdf(const std::string& file, const std::string& path, const VtkhdfPart& part,
                           const std::vector<VtkhdfSize>& sizes) {
  Hdf5File made(file, path);
  made.make_group("VTKHDF");
  made.write_attribute("VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
  made.write_attribute("VTKHDF", "Type", std::string("UnstructuredGrid"));
  const auto write_per_piece = [&](const std::string& name, const auto& number_of) {
    made.write_numbers<std::int64_t>(
        "VTKHDF/" + name, sizes.size(), 0,
        [&](std::uint64_t piece, std::uint64_t) { return number_of(sizes[piece]); });
  };
  const std::uint64_t corners = part.corners_per_cell();
  write_per_piece("NumberOfPoints", [](const VtkhdfSize& size) { return size.points; });
  write_per_piece("NumberOfCells", [](const VtkhdfSize& size) { return size.cells; });
  write_per_piece("NumberOfConnectivityIds", [&](const VtkhdfSize& size) { return corners * size.cells; });
  const VtkhdfSize all = before(sizes, sizes.size());
  VtkhdfArrays arrays;
  arrays.points = made.make_dataset("VTKHDF/Points", H5T_IEEE_F64LE, all.points, 3);
  arrays.connectivity = made.make_dataset("VTKHDF/Connectivity", H5T_STD_I64LE, corners * all.cells, 0);
  arrays.offsets = made.make_dataset("VTKHDF/Offsets", H5T_STD_I64LE, all.cells + sizes.size(), 0);
  arrays.types = made.make_dataset("VTKHDF/Types", H5T_STD_U8LE, all.cells, 0);
  made.make_group("VTKHDF/PointData");
  arrays.ids = made.make_dataset(std::string("VTKHDF/PointData/") + kGlobalIds, H5T_STD_I64LE, all.points, 0);
  made.make_group("VTKHDF/CellData");
  for (std::size_t side = 0; const std::string& name : part.names_of_labels())
    arrays.labels[side++] = made.make_dataset("VTKHDF/CellData/" + name, H5T_STD_U32LE, all.cells, 0);
  write_field_data(made, part.mesh());
  made.close();
  return arrays;
}

void write_vtkhdf_part(const std::string& file, const std::string& path, const VtkhdfPart& part,
                       const std::vector<VtkhdfSize>& sizes, int rank, const VtkhdfArrays& arrays) {
  const auto number = static_cast<std::size_t>(rank);
  const VtkhdfSize first = before(sizes, number), own = sizes[number];
  const std::uint64_t corners = part.corners_per_cell();
  SharedFile to(file, path);
  write_rows<double>(to, arrays.points, first.points, own.points,
                     [&](std::uint64_t i, std::uint64_t axis) { return part.point(i)[axis]; });
  write_rows<std::int64_t>(to, arrays.ids, first.points, own.points,
                           [&](std::uint64_t i, std::uint64_t) { return part.id(i); });
  write_rows<std::int64_t>(
      to, arrays.connectivity, corners * first.cells, corners * own.cells,
      [&](std::uint64_t i, std::uint64_t) { return part.corner(i / corners, i % corners); });
  write_rows<std::int64_t>(to, arrays.offsets, first.cells + number, own.cells + 1,
                           [&](std::uint64_t i, std::uint64_t) { return corners * i; });
  write_rows<std::uint8_t>(to, arrays.types, first.cells, own.cells,
                           [&](std::uint64_t, std::uint64_t) { return part.cell_type(); });
  for (std::size_t side = 0; side < part.names_of_labels().size(); ++side)
    write_rows<std::uint32_t>(to, arrays.labels[side], first.cells, own.cells,
                              [&](std::uint64_t i, std::uint64_t) { return part.label(i, side); });
  to.finish();
}

}  // namespace podm
