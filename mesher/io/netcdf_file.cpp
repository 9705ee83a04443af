#include "io/netcdf_file.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "files/big_endian.h"

namespace podm {
namespace {

constexpr std::int32_t kDimensionList = 10, kVariableList = 11, kAttributeList = 12;

constexpr std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

std::uint64_t size_of(NetcdfFile::Type type) {
  return type == NetcdfFile::kChar ? 1 : type == NetcdfFile::kDouble ? 8 : 4;
}

template <class Number>
std::string big_endian(Number number) {
  std::string bytes;
  for (std::size_t i = sizeof(Number); i-- > 0;)
    bytes += static_cast<char>(static_cast<std::uint64_t>(number) >> 8 * i);
  return bytes;
}

std::string as_int(std::uint64_t number) { return big_endian(static_cast<std::uint32_t>(number)); }

std::string filled_up(std::string bytes) {
  bytes.resize(padded(bytes.size()));
  return bytes;
}

std::string counted(const std::string& text) { return as_int(text.size()) + filled_up(text); }

// An empty list has no tag.
std::string list_head(std::int32_t tag, std::size_t size) {
  return as_int(size == 0 ? 0 : static_cast<std::uint64_t>(tag)) + as_int(size);
}

std::string attribute_list(const std::vector<NetcdfFile::Attribute>& attributes) {
  std::string bytes = list_head(kAttributeList, attributes.size());
  for (const NetcdfFile::Attribute& attribute : attributes)
    bytes += counted(attribute.name) + as_int(attribute.type) +
             as_int(static_cast<std::uint64_t>(attribute.count)) + filled_up(attribute.bytes);
  return bytes;
}

}  // namespace

NetcdfFile::Attribute::Attribute(std::string name_, const std::string& text)
    : name(std::move(name_)), type(kChar), count(static_cast<std::int32_t>(text.size())), bytes(text) {}
NetcdfFile::Attribute::Attribute(std::string name_, std::int32_t number)
    : name(std::move(name_)), type(kInt), count(1), bytes(big_endian(number)) {}
NetcdfFile::Attribute::Attribute(std::string name_, float number)
    : name(std::move(name_)),
      type(kFloat),
      count(1),
      bytes(big_endian(std::bit_cast<std::uint32_t>(number))) {}

NetcdfFile::Dimension NetcdfFile::add_dimension(const std::string& name, std::uint64_t size) {
  dimensions_.push_back({name, size});
  return dimensions_.size() - 1;
}

void NetcdfFile::add_variable(const std::string& name, Type type, std::vector<Dimension> dimensions,
                              std::function<void(AtomicFile&)> put, std::vector<Attribute> attributes) {
  variables_.push_back({name, type, std::move(dimensions), std::move(put), std::move(attributes)});
}

void NetcdfFile::add_ints(const std::string& name, Dimension dimension, std::vector<std::int32_t> values,
                          std::vector<Attribute> attributes) {
  add_variable(
      name, kInt, {dimension},
      [values = std::move(values)](AtomicFile& file) {
        for (const std::int32_t value : values) put_big_endian(file, value);
      },
      std::move(attributes));
}

void NetcdfFile::add_texts(const std::string& name, Dimension rows, Dimension columns,
                           std::vector<std::string> texts) {
  for (std::string& text : texts) text.resize(dimensions_[columns].size);
  add_variable(name, kChar, {rows, columns}, [texts = std::move(texts)](AtomicFile& file) {
    for (const std::string& text : texts) file.write(text);
  });
}

std::uint64_t NetcdfFile::bytes_of(const Variable& variable) const {
  std::uint64_t bytes = size_of(variable.type);
  for (const Dimension dimension : variable.dimensions) bytes *= dimensions_[dimension].size;
  return bytes;
}

std::string NetcdfFile::head(std::uint64_t first_byte) const {
  std::string bytes = "CDF\x02" + as_int(0);  // 64-bit offsets; no records
  bytes += list_head(kDimensionList, dimensions_.size());
  for (const NamedSize& dimension : dimensions_) bytes += counted(dimension.name) + as_int(dimension.size);
  bytes += attribute_list(attributes_) + list_head(kVariableList, variables_.size());
  for (const Variable& variable : variables_) {
    bytes += counted(variable.name) + as_int(variable.dimensions.size());
    // Bytes of one record, if the first dimension has no limit.
    std::uint64_t row_bytes = size_of(variable.type);
    for (const Dimension dimension : variable.dimensions) {
      bytes += as_int(dimension);
      row_bytes *= std::max<std::uint64_t>(dimensions_[dimension].size, 1);
    }
    bytes += attribute_list(variable.attributes) + as_int(variable.type) + as_int(padded(row_bytes)) +
             big_endian(first_byte);
    first_byte += padded(bytes_of(variable));
  }
  return bytes;
}

void NetcdfFile::write(AtomicFile& file) const {
  file.write(head(head(0).size()));
  for (const Variable& variable : variables_) {
    const std::uint64_t bytes = bytes_of(variable);
    if (bytes > 0) variable.put(file);
    file.write(std::string(padded(bytes) - bytes, '\0'));
  }
}

}  // namespace podm
