#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "ranks/part.h"
#include "report/reports.h"
#include "report/whole_file.h"

namespace podm::verify {

namespace {

// One array of a VTU file: its declaration in the head and its bytes in the tail.
struct VtuArray {
  std::string declaration;
  std::string bytes;
};

template <class Value>
VtuArray vtu_array(const std::string& type, const std::string& name, int components,
                   const std::vector<Value>& values) {
  VtuArray array{fmt::format(R"(type="{}" Name="{}" NumberOfComponents="{}")", type, name, components), {}};
  const std::uint64_t size = values.size() * sizeof(Value);
  array.bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  array.bytes.append(reinterpret_cast<const char*>(values.data()), size);
  return array;
}

std::string head_of(const std::vector<VtuArray>& arrays, std::size_t begin, std::size_t end) {
  std::string text;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < end; ++i) {
    if (i >= begin)
      text +=
          fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", arrays[i].declaration, offset);
    offset += arrays[i].bytes.size();
  }
  return text;
}

}  // namespace

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    const bool is_written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (std::fflush(stdout) != 0 || !is_written) refuse_to_write("standard output", errno);
    return;
  }
  if (!std::filesystem::exists(path) || std::filesystem::is_regular_file(path))
    return write_whole_file(path, text);
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) refuse_to_write(path, errno);
}

std::vector<BadCell> find_bad_cells(const Mesh& mesh, const std::vector<ClaimResult>& results) {
  std::map<GlobalId, std::uint64_t> claims_of;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i].verdict == Verdict::kFail)
      for (const GlobalId cell : results[i].bad_cells) claims_of[cell] |= std::uint64_t{1} << i;
  const IdRange own = own_cells(mesh);
  const GlobalId first = own.size() == 0 ? 0 : global_cell(mesh, static_cast<CellId>(own.begin));
  auto lists = lists_for<BadCell>(ranks_of(mesh));
  for (const auto& [id, claims] : claims_of) {
    const auto c = static_cast<CellId>(id - first + own.begin);
    const auto& v = mesh.cells[c];
    if (std::any_of(v.begin(), v.end(), [&](VertexId x) { return x >= mesh.vertices.size(); })) continue;
    BadCell bad{id, {}, mesh.cell_labels.empty() ? 0 : mesh.cell_labels[c], claims};
    for (std::size_t i = 0; i < 4; ++i) bad.points[i] = mesh.vertices[v[i]];
    lists[0].push_back(bad);
  }
  return exchange_joined(ranks_of(mesh), std::move(lists));
}

void write_bad_cells(const std::string& path, const std::vector<BadCell>& cells,
                     const std::vector<ClaimResult>& results) {
  std::vector<Point> points;
  std::vector<GlobalId> ids;
  std::vector<std::int64_t> connectivity, offsets, labels;
  for (const BadCell& cell : cells) {
    for (const Point& point : cell.points) {
      connectivity.push_back(static_cast<std::int64_t>(points.size()));
      points.push_back(point);
    }
    offsets.push_back(static_cast<std::int64_t>(points.size()));
    ids.push_back(cell.id);
    labels.push_back(cell.label);
  }
  std::vector<VtuArray> arrays{vtu_array("Float64", "Points", 3, points),
                               vtu_array("Int64", "connectivity", 1, connectivity),
                               vtu_array("Int64", "offsets", 1, offsets),
                               vtu_array("UInt8", "types", 1, std::vector<std::uint8_t>(cells.size(), 10)),
                               vtu_array("UInt64", "cell", 1, ids),
                               vtu_array("Int64", "label", 1, labels)};
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i].verdict != Verdict::kFail) continue;
    std::vector<std::uint8_t> is_bad;
    for (const BadCell& cell : cells) is_bad.push_back(cell.claims >> i & 1);
    arrays.push_back(vtu_array("UInt8", results[i].claim, 1, is_bad));
  }
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      points.size(), cells.size());
  text += "<Points>\n" + head_of(arrays, 0, 1) + "</Points>\n<Cells>\n" + head_of(arrays, 1, 4) +
          "</Cells>\n<CellData>\n" + head_of(arrays, 4, arrays.size()) + "</CellData>\n";
  text += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  for (const VtuArray& array : arrays) text += array.bytes;
  write_text(path, text + "\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace podm::verify
