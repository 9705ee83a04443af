// The declarations in a VTU file's XML: pieces, arrays, and where the numbers of each array are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "readers/mesh_file.h"
#include "readers/number_array.h"

namespace podm::verify {

/// VTK's name for the point array that numbers a piece's points in the whole mesh.
inline constexpr const char* kGlobalIds = "GlobalNodeIds";

struct VtuArray {
  std::string name;
  NumberType type = NumberType::kUInt8;
  std::size_t num_components = 1;
  enum class Format { kAscii, kInlineBase64, kAppended } format = Format::kAscii;
  std::uint64_t begin = 0;  ///< begin of its text in the file; appended: offset in the appended data
  std::uint64_t end = 0;    ///< end of its text
  std::size_t line = 0;

  std::string place() const;  ///< "line 12, DataArray 'label'"
};

struct VtuPiece {
  std::size_t line = 0;
  std::uint64_t num_points = 0, num_cells = 0;
  std::vector<VtuArray> points, cells, cell_data, point_data;
};

struct VtuDocument {
  bool is_big_endian = false, has_wide_headers = false, is_zlib = false;
  std::vector<VtuArray> field_data;
  std::vector<VtuPiece> pieces;
  std::optional<std::size_t> appended_begin;  ///< begin of the appended data in the file
  bool is_appended_base64 = false;
  std::uint64_t appended_bytes_loaded = 0;
};

/// Keeps the arrays that a mesh consists of and skips all others. Refuses document types (and so entities),
/// deep nesting, and tags of more than a megabyte. Throws InputError with the line.
VtuDocument parse_vtu(const MeshFile& file);

/// Returns the decoded numbers of one array. Throws InputError unless there are `count` of them (none: any
/// number). Appended arrays may not overlap: together they are no longer than the data, so a small file stays
/// small.
NumberArray load_vtu_array(const MeshFile& file, VtuDocument& document, const VtuArray& array,
                           std::optional<std::uint64_t> count);

}  // namespace podm::verify
