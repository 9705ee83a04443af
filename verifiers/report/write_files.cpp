#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>

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

void write_bad_cells(const std::string& path, const Mesh& mesh, const std::vector<ClaimResult>& results) {
  std::vector<std::uint32_t> cells;
  for (const ClaimResult& result : results)
    if (result.verdict == Verdict::kFail)
      cells.insert(cells.end(), result.bad_cells.begin(), result.bad_cells.end());
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::erase_if(cells, [&](CellId c) {  // cells without all their vertices cannot be drawn
    const auto& v = mesh.cells[c];
    return std::any_of(v.begin(), v.end(), [&](VertexId id) { return id >= mesh.vertices.size(); });
  });

  std::vector<Point> points;
  std::vector<std::int64_t> connectivity, offsets, labels;
  for (const CellId c : cells) {
    for (const VertexId v : mesh.cells[c]) {
      connectivity.push_back(static_cast<std::int64_t>(points.size()));
      points.push_back(mesh.vertices[v]);
    }
    offsets.push_back(static_cast<std::int64_t>(points.size()));
    labels.push_back(mesh.cell_labels.empty() ? 0 : mesh.cell_labels[c]);
  }
  std::vector<VtuArray> arrays{vtu_array("Float64", "Points", 3, points),
                               vtu_array("Int64", "connectivity", 1, connectivity),
                               vtu_array("Int64", "offsets", 1, offsets),
                               vtu_array("UInt8", "types", 1, std::vector<std::uint8_t>(cells.size(), 10)),
                               vtu_array("UInt32", "cell", 1, cells),
                               vtu_array("Int64", "label", 1, labels)};
  for (const ClaimResult& result : results) {
    if (result.verdict != Verdict::kFail) continue;
    std::vector<std::uint8_t> is_bad;
    for (const CellId c : cells)
      is_bad.push_back(std::binary_search(result.bad_cells.begin(), result.bad_cells.end(), c));
    arrays.push_back(vtu_array("UInt8", result.claim, 1, is_bad));
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
