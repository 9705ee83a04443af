// A file of netCDF's classic format with 64-bit offsets: a head that declares arrays, then the arrays one
// after the other, big-endian. This code does not use the netCDF library, for two reasons. The library
// requires a file name, but an AtomicFile has none until it is complete. The library also links a Web client.
// Format: NetCDF User's Guide, "The NetCDF Classic Format Specification".
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "files/atomic_file.h"

namespace podm {

class NetcdfFile {
 public:
  enum Type : std::int32_t { kChar = 2, kInt = 4, kFloat = 5, kDouble = 6 };
  using Dimension = std::size_t;

  /// An attribute: text, one int or one float.
  struct Attribute {
    Attribute(std::string name_, const std::string& text);
    Attribute(std::string name_, std::int32_t number);
    Attribute(std::string name_, float number);
    std::string name;
    Type type;
    std::int32_t count;
    std::string bytes;
  };

  /// Adds a dimension. Size 0 means an unlimited dimension of the format.
  Dimension add_dimension(const std::string& name, std::uint64_t size);
  void add_attribute(Attribute attribute) { attributes_.push_back(std::move(attribute)); }
  /// `put` writes the values, which fill the dimensions, big-endian. Variables of the unlimited dimension
  /// have no values, and must come last.
  void add_variable(const std::string& name, Type type, std::vector<Dimension> dimensions,
                    std::function<void(AtomicFile&)> put, std::vector<Attribute> attributes = {});
  /// Adds an array of ints.
  void add_ints(const std::string& name, Dimension dimension, std::vector<std::int32_t> values,
                std::vector<Attribute> attributes = {});
  /// Adds one text per row, padded with zero bytes.
  void add_texts(const std::string& name, Dimension rows, Dimension columns, std::vector<std::string> texts);

  void write(AtomicFile& file) const;

 private:
  struct NamedSize {
    std::string name;
    std::uint64_t size;
  };
  struct Variable {
    std::string name;
    Type type;
    std::vector<Dimension> dimensions;
    std::function<void(AtomicFile&)> put;
    std::vector<Attribute> attributes;
  };
  std::uint64_t bytes_of(const Variable& variable) const;
  std::string head(std::uint64_t first_byte) const;

  std::vector<NamedSize> dimensions_;
  std::vector<Attribute> attributes_;
  std::vector<Variable> variables_;
};

}  // namespace podm
