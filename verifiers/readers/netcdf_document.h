// What a netCDF file declares: dimensions, and arrays of these with attributes. Classic files are read, of
// 32-bit and 64-bit offsets and of 64-bit data; netCDF-4, which is HDF5, is refused with a hint.
// Format: NetCDF User's Guide, "The NetCDF Classic Format Specification".
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "readers/cursor.h"
#include "readers/mesh_file.h"
#include "readers/number_array.h"

namespace podm::verify {

struct NetcdfVariable {
  std::int32_t type = 0;
  std::vector<std::uint64_t> sizes;               ///< of its dimensions; 0: the one without a limit
  std::map<std::string, std::string> attributes;  ///< those that are text
  std::uint64_t begin = 0;                        ///< byte in the file
};

class NetcdfDocument {
 public:
  /// Throws InputError.
  explicit NetcdfDocument(const MeshFile& file);

  int version() const { return version_; }
  /// The size of a dimension; 0 where there is none of that name.
  std::uint64_t size_of(const std::string& dimension) const;
  /// Null where there is none.
  const NetcdfVariable* find(const std::string& name) const;

  /// Throws InputError unless the variable is there with so many numbers, which the file holds.
  NumberArray numbers(const std::string& name, std::uint64_t count) const;
  /// The rows of an array of characters, each up to its first zero; none where there is no such array.
  std::vector<std::string> texts(const std::string& name) const;

 private:
  std::uint64_t read_size(const char* what);  // as wide as the version has it
  std::string read_name();
  std::size_t read_list_head(std::int32_t tag, const char* what);
  std::map<std::string, std::string> read_attributes();
  void read_dimensions();
  void read_variables();
  std::string_view bytes_of(const std::string& name, const NetcdfVariable& variable) const;

  const MeshFile& file_;
  Cursor cursor_;
  int version_ = 1;
  std::vector<std::pair<std::string, std::uint64_t>> dimensions_;
  std::map<std::string, NetcdfVariable> variables_;
};

}  // namespace podm::verify
