// Writers of every variant of every format, as short as possible.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "mesh.h"

namespace podm::verify {

/// Writes numbers as bytes in either byte order.
class Bytes {
 public:
  explicit Bytes(bool is_big_endian)
      : is_swapped_(is_big_endian != (std::endian::native == std::endian::big)) {}

  template <class Number>
  void put(Number number) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, &number, sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i) text += bytes[is_swapped_ ? sizeof(Number) - 1 - i : i];
  }
  /// Writes the number in the VTU type of this name.
  void put_as(const std::string& type, double number);

  std::string text;

 private:
  bool is_swapped_;
};

struct VtuOptions {
  enum Encoding { kAscii, kInline, kAppendedRaw, kAppendedBase64 } encoding = kAscii;
  bool is_zlib = false, has_wide_headers = true, is_big_endian = false;
  std::string id_type = "Int32", real_type = "Float64", label_type = "UInt32";
  int num_pieces = 1;  ///< 2: the last cell has a piece and points of its own
  std::size_t block_size = 64;
};
std::string vtu_text(const Mesh& mesh, const VtuOptions& options);

std::string legacy_vtk_text(const Mesh& mesh, bool is_binary, bool has_offsets);
std::string medit_text(const Mesh& mesh);
std::string medit_bytes(const Mesh& mesh, int version, bool is_big_endian);
std::string gmsh_v2_text(const Mesh& mesh);
std::string gmsh_v2_bytes(const Mesh& mesh, bool is_big_endian);
/// The node tag of vertex i is first_tag + i * tag_step.
std::string gmsh_v4_text(const Mesh& mesh, std::uint64_t first_tag = 1, std::uint64_t tag_step = 1);
std::string gmsh_v4_bytes(const Mesh& mesh, int size_bytes, bool is_big_endian);
std::string tetgen_nodes(const Mesh& mesh, int base);
std::string tetgen_elements(const Mesh& mesh, int base);
std::string tetgen_faces(const Mesh& mesh, int base);

}  // namespace podm::verify
