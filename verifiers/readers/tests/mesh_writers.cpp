#include "readers/tests/mesh_writers.h"

#include <fmt/format.h>

namespace podm::verify {
namespace {

std::string in_text(const Point& point) { return fmt::format("{} {} {}", point[0], point[1], point[2]); }

template <std::size_t N>
std::string in_text(const std::array<VertexId, N>& ids, std::uint64_t first, std::uint64_t step = 1) {
  std::string text;
  for (const VertexId id : ids) text += fmt::format(" {}", first + id * step);
  return text;
}

}  // namespace

std::string legacy_vtk_text(const Mesh& mesh, bool is_binary, bool has_offsets) {
  const std::size_t num_cells = mesh.cells.size() + mesh.facets.size();
  const std::size_t num_ids = 4 * mesh.cells.size() + 3 * mesh.facets.size();
  Bytes bytes(true);
  std::string& text = bytes.text;
  const auto put = [&](auto number) {
    is_binary ? bytes.put(number) : void(text += fmt::format("{} ", number));
  };
  using Int = std::int32_t;
  using Long = std::int64_t;
  const auto put_ids = [&](const auto& ids, bool with_count) {
    if (with_count) put(static_cast<Int>(ids.size()));
    for (const VertexId id : ids) with_count ? put(static_cast<Int>(id)) : put(static_cast<Long>(id));
  };
  text = fmt::format("# vtk DataFile Version {}\na title\n{}\nDATASET UNSTRUCTURED_GRID\n",
                     has_offsets ? "5.1" : "3.0", is_binary ? "BINARY" : "ASCII");
  text += fmt::format("POINTS {} double\n", mesh.vertices.size());
  for (const Point& point : mesh.vertices)
    for (const double coordinate : point) put(coordinate);
  if (has_offsets) {
    text += fmt::format("\nCELLS {} {}\nOFFSETS vtktypeint64\n", num_cells + 1, num_ids);
    for (std::size_t i = 0; i <= num_cells; ++i)
      put(static_cast<Long>(i <= mesh.facets.size() ? 3 * i : 4 * i - mesh.facets.size()));
    text += "\nCONNECTIVITY vtktypeint64\n";
  } else {
    text += fmt::format("\nCELLS {} {}\n", num_cells, num_cells + num_ids);
  }
  for (const auto& facet : mesh.facets) put_ids(facet, !has_offsets);
  for (const auto& cell : mesh.cells) put_ids(cell, !has_offsets);
  text += fmt::format("\nCELL_TYPES {}\n", num_cells);
  for (std::size_t i = 0; i < num_cells; ++i) put(Int{i < mesh.facets.size() ? 5 : 10});
  text += fmt::format("\nCELL_DATA {}\nSCALARS label int 1\nLOOKUP_TABLE default\n", num_cells);
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) put(Int{0});
  for (const LabelValue label : mesh.cell_labels) put(static_cast<Int>(label));
  return text + "\n";
}

std::string medit_text(const Mesh& mesh) {
  std::string text = fmt::format("MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n", mesh.vertices.size());
  for (const Point& point : mesh.vertices) text += in_text(point) + " 0\n";
  text += fmt::format("Corners 2\n1\n2\nTriangles\n{}\n", mesh.facets.size());
  for (const auto& facet : mesh.facets) text += in_text(facet, 1) + " 5\n";
  text += fmt::format("Tetrahedra\n{}\n", mesh.cells.size());
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    text += in_text(mesh.cells[i], 1) + fmt::format(" {}\n", mesh.cell_labels[i]);
  return text + "End\n";
}

std::string medit_bytes(const Mesh& mesh, int version, bool is_big_endian) {
  Bytes bytes(is_big_endian);
  using Int = std::int32_t;
  const auto put_int = [&](std::int64_t n) { version == 4 ? bytes.put(n) : bytes.put(static_cast<Int>(n)); };
  const auto put_real = [&](double x) { version == 1 ? bytes.put(static_cast<float>(x)) : bytes.put(x); };
  const std::size_t position_bytes = version >= 3 ? 8 : 4, int_bytes = version == 4 ? 8 : 4;
  const auto begin = [&](Int keyword, std::size_t num_bytes) {
    bytes.put(keyword);
    const std::size_t next = bytes.text.size() + position_bytes + num_bytes;
    version >= 3 ? bytes.put(static_cast<std::int64_t>(next)) : bytes.put(static_cast<Int>(next));
  };
  bytes.put(Int{1});
  bytes.put(Int{version});
  begin(3, 4);
  bytes.put(Int{3});
  begin(4, int_bytes + mesh.vertices.size() * (int_bytes + 3 * (version == 1 ? 4 : 8)));
  put_int(static_cast<std::int64_t>(mesh.vertices.size()));
  for (const Point& point : mesh.vertices) {
    for (const double coordinate : point) put_real(coordinate);
    put_int(0);
  }
  begin(13, int_bytes * 3);  // corners
  for (const int n : {2, 1, 2}) put_int(n);
  const auto put_cells = [&](Int keyword, const auto& cells, auto reference_of) {
    begin(keyword, int_bytes * (1 + cells.size() * (cells[0].size() + 1)));
    put_int(static_cast<std::int64_t>(cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const VertexId id : cells[i]) put_int(std::int64_t{id} + 1);
      put_int(reference_of(i));
    }
  };
  put_cells(6, mesh.facets, [](std::size_t) { return 5; });
  put_cells(8, mesh.cells, [&](std::size_t i) { return mesh.cell_labels[i]; });
  bytes.put(Int{54});
  return bytes.text + std::string(position_bytes, '\0');
}

std::string gmsh_v2_text(const Mesh& mesh) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    text += fmt::format("{} {}\n", i + 1, in_text(mesh.vertices[i]));
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.facets.size() + mesh.cells.size());
  for (const auto& facet : mesh.facets) text += "9 2 2 4 1" + in_text(facet, 1) + "\n";
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    text += fmt::format("9 4 2 {} 1{}\n", mesh.cell_labels[i], in_text(mesh.cells[i], 1));
  return text + "$EndElements\n";
}

std::string gmsh_v2_bytes(const Mesh& mesh, bool is_big_endian) {
  Bytes bytes(is_big_endian);
  using Int = std::int32_t;
  bytes.text += "$MeshFormat\n2.2 1 8\n";
  bytes.put(Int{1});
  bytes.text += fmt::format("\n$EndMeshFormat\n$Nodes\n{}\n", mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    bytes.put(static_cast<Int>(i + 1));
    for (const double coordinate : mesh.vertices[i]) bytes.put(coordinate);
  }
  bytes.text += fmt::format("\n$EndNodes\n$Elements\n{}\n", mesh.facets.size() + mesh.cells.size());
  const auto put_cells = [&](Int type, const auto& cells, auto label_of) {
    for (const Int n : {type, static_cast<Int>(cells.size()), Int{2}}) bytes.put(n);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const Int n : {Int{9}, label_of(i), Int{1}}) bytes.put(n);
      for (const VertexId id : cells[i]) bytes.put(static_cast<Int>(id + 1));
    }
  };
  put_cells(2, mesh.facets, [](std::size_t) { return Int{4}; });
  put_cells(4, mesh.cells, [&](std::size_t i) { return static_cast<Int>(mesh.cell_labels[i]); });
  return bytes.text + "\n$EndElements\n";
}

// Each cell has a block and a volume of its own, so the cells keep their order.
std::string gmsh_v4_text(const Mesh& mesh, std::uint64_t first_tag, std::uint64_t tag_step) {
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n";
  text += fmt::format("0 0 1 {}\n1 0 0 0 1 1 1 0 0\n", mesh.cells.size());
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    text += fmt::format("{} 0 0 0 1 1 1 1 {} 1 -1\n", i + 1, mesh.cell_labels[i]);
  const std::uint64_t last_tag = first_tag + tag_step * (mesh.vertices.size() - 1);
  text += fmt::format("$EndEntities\n$Nodes\n1 {0} {1} {2}\n3 1 0 {0}\n", mesh.vertices.size(), first_tag,
                      last_tag);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    text += fmt::format("{}\n", first_tag + i * tag_step);
  for (const Point& point : mesh.vertices) text += in_text(point) + "\n";
  const std::size_t num_elements = mesh.cells.size() + mesh.facets.size();
  text += fmt::format("$EndNodes\n$Elements\n{} {} 1 9\n2 1 2 {}\n", mesh.cells.size() + 1, num_elements,
                      mesh.facets.size());
  for (const auto& facet : mesh.facets) text += fmt::format("9{}\n", in_text(facet, first_tag, tag_step));
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    text += fmt::format("3 {} 4 1\n9{}\n", i + 1, in_text(mesh.cells[i], first_tag, tag_step));
  return text + "$EndElements\n";
}

std::string gmsh_v4_bytes(const Mesh& mesh, int size_bytes, bool is_big_endian) {
  Bytes bytes(is_big_endian);
  using Int = std::int32_t;
  const auto put_sizes = [&](std::initializer_list<std::size_t> sizes) {
    for (const std::size_t n : sizes)
      size_bytes == 8 ? bytes.put(std::uint64_t{n}) : bytes.put(static_cast<std::uint32_t>(n));
  };
  const auto put_ints = [&](std::initializer_list<std::size_t> numbers) {
    for (const std::size_t n : numbers) bytes.put(static_cast<Int>(n));
  };
  const std::size_t num_cells = mesh.cells.size(), num_facets = mesh.facets.size();
  bytes.text = fmt::format("$MeshFormat\n4.1 1 {}\n", size_bytes);
  bytes.put(Int{1});
  bytes.text += "\n$EndMeshFormat\n$Entities\n";
  put_sizes({0, 0, 0, num_cells});
  for (std::size_t i = 0; i < num_cells; ++i) {
    put_ints({i + 1});
    for (int k = 0; k < 6; ++k) bytes.put(0.0);
    put_sizes({1});
    put_ints({static_cast<std::size_t>(mesh.cell_labels[i])});
    put_sizes({0});
  }
  bytes.text += "\n$EndEntities\n$Nodes\n";
  put_sizes({1, mesh.vertices.size(), 1, mesh.vertices.size()});
  put_ints({3, 1, 0});
  put_sizes({mesh.vertices.size()});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) put_sizes({i + 1});
  for (const Point& point : mesh.vertices)
    for (const double coordinate : point) bytes.put(coordinate);
  bytes.text += "\n$EndNodes\n$Elements\n";
  put_sizes({num_cells + 1, num_cells + num_facets, 1, num_cells + num_facets});
  put_ints({2, 1, 2});
  put_sizes({num_facets});
  for (const auto& [a, b, c] : mesh.facets) put_sizes({9, a + 1u, b + 1u, c + 1u});
  for (std::size_t i = 0; i < num_cells; ++i) {
    put_ints({3, i + 1, 4});
    const auto& [a, b, c, d] = mesh.cells[i];
    put_sizes({1, 9, a + 1u, b + 1u, c + 1u, d + 1u});
  }
  return bytes.text + "\n$EndElements\n";
}

std::string tetgen_nodes(const Mesh& mesh, int base) {
  std::string text = fmt::format("# nodes\n{} 3 1 1\n", mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    text += fmt::format("  {} {} 0.5 1 # marked\n", i + static_cast<std::size_t>(base),
                        in_text(mesh.vertices[i]));
  return text;
}

std::string tetgen_elements(const Mesh& mesh, int base) {
  std::string text = fmt::format("{} 4 1\n", mesh.cells.size());
  const auto first = static_cast<std::uint64_t>(base);
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    text += fmt::format("{}{} {}\n", i + first, in_text(mesh.cells[i], first), mesh.cell_labels[i]);
  return text + "# Generated by tetgen\n";
}

std::string tetgen_faces(const Mesh& mesh, int base) {
  std::string text = fmt::format("{} 1\n", mesh.facets.size());
  const auto first = static_cast<std::uint64_t>(base);
  for (std::size_t i = 0; i < mesh.facets.size(); ++i)
    text += fmt::format("{}{} -1\n", i + first, in_text(mesh.facets[i], first));
  return text;
}

}  // namespace podm::verify
