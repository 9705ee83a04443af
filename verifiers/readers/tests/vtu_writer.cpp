#include <fmt/format.h>
#include <zlib.h>

#include <functional>

#include "readers/tests/mesh_writers.h"

namespace podm::verify {
namespace {

std::string base64(const std::string& bytes) {
  constexpr const char* kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kAlphabet[group >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           bytes.size());
  packed.resize(size);
  return packed;
}

class VtuWriter {
 public:
  VtuWriter(const Mesh& mesh, const VtuOptions& options) : mesh_(mesh), options_(options) {}

  std::string write() {
    text_ = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
        "header_type=\"{}\"{}>\n<UnstructuredGrid>\n",
        options_.is_big_endian ? "BigEndian" : "LittleEndian",
        options_.has_wide_headers ? "UInt64" : "UInt32",
        options_.is_zlib ? " compressor=\"vtkZLibDataCompressor\"" : "");
    const std::size_t num_cells = mesh_.cells.size();
    if (options_.num_pieces == 1) {
      write_piece(0, mesh_.vertices.size(), 0, num_cells);
    } else {  // each piece lists all points
      write_piece(0, mesh_.vertices.size(), 0, num_cells - 1);
      write_piece(0, mesh_.vertices.size(), num_cells - 1, num_cells);
    }
    text_ += "</UnstructuredGrid>\n";
    if (options_.encoding >= VtuOptions::kAppendedRaw) {
      text_ += fmt::format("<AppendedData encoding=\"{}\">\n_",
                           options_.encoding == VtuOptions::kAppendedRaw ? "raw" : "base64");
      text_ += appended_ + "\n</AppendedData>\n";
    }
    return text_ + "</VTKFile>\n";
  }

 private:
  void write_piece(std::size_t first_point, std::size_t end_point, std::size_t first_cell,
                   std::size_t end_cell) {
    const std::size_t num_points = end_point - first_point, num_cells = end_cell - first_cell;
    text_ +=
        fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", num_points, num_cells);
    write_array("Points", options_.real_type, 3, 3 * num_points,
                [&](std::size_t i) { return mesh_.vertices[first_point + i / 3][i % 3]; });
    text_ += "</Points>\n<Cells>\n";
    write_array("connectivity", options_.id_type, 1, 4 * num_cells,
                [&](std::size_t i) { return mesh_.cells[first_cell + i / 4][i % 4] - first_point; });
    write_array("offsets", options_.id_type, 1, num_cells, [](std::size_t i) { return 4 * i + 4; });
    write_array("types", "UInt8", 1, num_cells, [](std::size_t) { return 10; });
    text_ += "</Cells>\n<CellData Scalars=\"label\">\n";
    write_array("quality", "Float32", 1, num_cells,
                [](std::size_t i) { return 0.5 + static_cast<double>(i); });
    write_array("label", options_.label_type, 1, num_cells,
                [&](std::size_t i) { return static_cast<double>(mesh_.cell_labels[first_cell + i]); });
    text_ += "</CellData>\n</Piece>\n";
  }

  template <class ValueAt>
  void write_array(const std::string& name, const std::string& type, int num_components, std::size_t count,
                   ValueAt value_at) {
    const char* formats[] = {"ascii", "binary", "appended", "appended"};
    text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"{}\"", type,
                         name, num_components, formats[options_.encoding]);
    if (options_.encoding == VtuOptions::kAscii) {
      text_ += ">\n<InformationKey name=\"RANGE\"><Value index=\"0\">3</Value></InformationKey>\n";
      for (std::size_t i = 0; i < count; ++i) text_ += fmt::format("{} ", value_at(i));
      text_ += "\n</DataArray>\n";
      return;
    }
    Bytes bytes(options_.is_big_endian);
    for (std::size_t i = 0; i < count; ++i) bytes.put_as(type, static_cast<double>(value_at(i)));
    const bool is_raw = options_.encoding == VtuOptions::kAppendedRaw;
    const std::string encoded = options_.is_zlib ? compressed(bytes.text, is_raw) : plain(bytes.text, is_raw);
    if (options_.encoding == VtuOptions::kInline) {
      text_ += ">\n" + encoded + "\n</DataArray>\n";
    } else {
      text_ += fmt::format(" offset=\"{}\"/>\n", appended_.size());
      appended_ += encoded;
    }
  }

  void put_header(Bytes& bytes, std::size_t number) const {
    bytes.put_as(options_.has_wide_headers ? "UInt64" : "UInt32", static_cast<double>(number));
  }

  std::string plain(const std::string& values, bool is_raw) const {
    Bytes bytes(options_.is_big_endian);
    put_header(bytes, values.size());
    return is_raw ? bytes.text + values : base64(bytes.text + values);
  }

  std::string compressed(const std::string& values, bool is_raw) const {
    const std::size_t size = options_.block_size, num_blocks = (values.size() + size - 1) / size;
    Bytes header(options_.is_big_endian);
    for (const std::size_t number : {num_blocks, size, values.size() % size}) put_header(header, number);
    std::string blocks;
    for (std::size_t i = 0; i < num_blocks; ++i) {
      const std::string block = deflated(values.substr(i * size, size));
      put_header(header, block.size());
      blocks += block;
    }
    return is_raw ? header.text + blocks : base64(header.text) + base64(blocks);
  }

  const Mesh& mesh_;
  const VtuOptions& options_;
  std::string text_, appended_;
};

}  // namespace

void Bytes::put_as(const std::string& type, double number) {
  if (type == "Int8") return put(static_cast<std::int8_t>(number));
  if (type == "UInt8") return put(static_cast<std::uint8_t>(number));
  if (type == "Int16") return put(static_cast<std::int16_t>(number));
  if (type == "UInt16") return put(static_cast<std::uint16_t>(number));
  if (type == "Int32") return put(static_cast<std::int32_t>(number));
  if (type == "UInt32") return put(static_cast<std::uint32_t>(number));
  if (type == "Int64") return put(static_cast<std::int64_t>(number));
  if (type == "UInt64") return put(static_cast<std::uint64_t>(number));
  if (type == "Float32") return put(static_cast<float>(number));
  put(number);
}

std::string vtu_text(const Mesh& mesh, const VtuOptions& options) { return VtuWriter(mesh, options).write(); }

}  // namespace podm::verify
