// The declarations of a netCDF file: dimensions, and arrays over them with attributes. It reads classic files
// with 32-bit offsets, 64-bit offsets or 64-bit data. It refuses netCDF-4, which is HDF5, with a hint.
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
  std::vector<std::uint64_t> sizes;               ///< sizes of its dimensions; 0: the unlimited one
  std::map<std::string, std::string> attributes;  ///< text attributes only
  std::uint64_t begin = 0;                        ///< byte in the file
};

class NetcdfDocument {
 public:
  /// Throws InputError.
  explicit NetcdfDocument(const MeshFile& file);

  int version() const { return version_; }
  /// Returns the size of a dimension; 0 if no dimension has that name.
  std::uint64_t size_of(const std::string& dimension) const;
  /// Returns null if no variable has that name.
  const NetcdfVariable* find(const std::string& name) const;

  /// Throws InputError unless the variable exists and has `count` numbers, all within the file.
  NumberArray numbers(const std::string& name, std::uint64_t count) const;
  /// Returns the rows of an array of characters, each up to its first zero; none if the array does not exist.
  std::vector<std::string> texts(const std::string& name) const;

 private:
  std::uint64_t read_size(const char* what);  // as wide as in this version
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
