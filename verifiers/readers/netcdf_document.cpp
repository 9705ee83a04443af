#include "readers/netcdf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

namespace podm::verify {
namespace {

constexpr std::int32_t kDimensionList = 10, kVariableList = 11, kAttributeList = 12;
constexpr std::int32_t kChar = 2;
constexpr bool kIsSwapped = std::endian::native == std::endian::little;  // files are big-endian

std::optional<NumberType> number_type(std::int32_t type) {
  constexpr NumberType kTypes[] = {NumberType::kInt8,  NumberType::kUInt8,   NumberType::kInt16,
                                   NumberType::kInt32, NumberType::kFloat32, NumberType::kFloat64,
                                   NumberType::kUInt8, NumberType::kUInt16,  NumberType::kUInt32,
                                   NumberType::kInt64, NumberType::kUInt64};
  if (type < 1 || type > static_cast<std::int32_t>(std::size(kTypes))) return std::nullopt;
  return kTypes[type - 1];
}

}  // namespace

NetcdfDocument::NetcdfDocument(const MeshFile& file) : file_(file), cursor_(file) {
  cursor_.name_bytes();
  if (file.bytes().starts_with("\x89HDF"))
    cursor_.refuse("netCDF-4 is not read; `nccopy -k cdf5 FILE NEW_FILE` of netcdf-bin makes it classic");
  const std::string_view magic = cursor_.raw(4, "the mark of the format");
  version_ = magic[3];
  if (!magic.starts_with("CDF") || (version_ != 1 && version_ != 2 && version_ != 5))
    cursor_.refuse("not a netCDF file: it does not begin with CDF and 1, 2 or 5");
  read_size("the number of records");
  read_dimensions();
  read_attributes();  // attributes of the file
  read_variables();
}

std::uint64_t NetcdfDocument::read_size(const char* what) {
  return version_ == 5 ? cursor_.raw_number<std::uint64_t>(kIsSwapped, what)
                       : cursor_.raw_number<std::uint32_t>(kIsSwapped, what);
}

std::string NetcdfDocument::read_name() {
  const std::uint64_t size = read_size("the length of a name");
  const std::string name(cursor_.raw(size, "a name"));
  cursor_.raw((4 - size % 4) % 4, "a name");
  return name;
}

std::size_t NetcdfDocument::read_list_head(std::int32_t tag, const char* what) {
  const auto found = cursor_.raw_number<std::int32_t>(kIsSwapped, what);
  if (found != tag && found != 0) cursor_.refuse(fmt::format("{} begins with {}, not {}", what, found, tag));
  const std::uint64_t count = read_size(what);
  if (found == 0 && count != 0) cursor_.refuse(fmt::format("{} has no tag", what));
  cursor_.expect_room(count, 8, what);
  return count;
}

std::map<std::string, std::string> NetcdfDocument::read_attributes() {
  std::map<std::string, std::string> texts;
  for (std::size_t n = read_list_head(kAttributeList, "the list of attributes"); n > 0; --n) {
    const std::string name = read_name();
    const auto type = cursor_.raw_number<std::int32_t>(kIsSwapped, "the type of an attribute");
    if (!number_type(type)) cursor_.refuse(fmt::format("attribute '{}' has type {}", name, type));
    const std::uint64_t count = read_size("the length of an attribute"),
                        width = podm::verify::size_of(*number_type(type));
    cursor_.expect_room(count, width, "the length of an attribute");
    const std::string_view bytes = cursor_.raw(count * width, "an attribute");
    cursor_.raw((4 - bytes.size() % 4) % 4, "an attribute");
    if (type == kChar) texts[name] = bytes.substr(0, bytes.find('\0'));
  }
  return texts;
}

void NetcdfDocument::read_dimensions() {
  for (std::size_t n = read_list_head(kDimensionList, "the list of dimensions"); n > 0; --n) {
    std::string name = read_name();
    dimensions_.emplace_back(std::move(name), read_size("a dimension"));
  }
}

void NetcdfDocument::read_variables() {
  for (std::size_t n = read_list_head(kVariableList, "the list of variables"); n > 0; --n) {
    const std::string name = read_name();
    NetcdfVariable variable;
    const std::uint64_t num_dimensions = read_size("the dimensions of a variable");
    cursor_.expect_room(num_dimensions, 4, "the dimensions of a variable");
    for (std::uint64_t i = 0; i < num_dimensions; ++i) {
      const std::uint64_t dimension = read_size("a dimension of a variable");
      if (dimension >= dimensions_.size())
        cursor_.refuse(
            fmt::format("variable '{}' has dimension {} of {}", name, dimension, dimensions_.size()));
      variable.sizes.push_back(dimensions_[dimension].second);
    }
    variable.attributes = read_attributes();
    variable.type = cursor_.raw_number<std::int32_t>(kIsSwapped, "the type of a variable");
    if (!number_type(variable.type))
      cursor_.refuse(fmt::format("variable '{}' has type {}", name, variable.type));
    read_size("the size of a variable");  // redundant: it follows from type and dimensions
    variable.begin = version_ == 1 ? cursor_.raw_number<std::uint32_t>(kIsSwapped, "the place of a variable")
                                   : cursor_.raw_number<std::uint64_t>(kIsSwapped, "the place of a variable");
    variables_[name] = std::move(variable);
  }
}

std::uint64_t NetcdfDocument::size_of(const std::string& dimension) const {
  const auto found = std::find_if(dimensions_.begin(), dimensions_.end(),
                                  [&](const auto& named) { return named.first == dimension; });
  return found == dimensions_.end() ? 0 : found->second;
}

const NetcdfVariable* NetcdfDocument::find(const std::string& name) const {
  const auto found = variables_.find(name);
  return found == variables_.end() ? nullptr : &found->second;
}

std::string_view NetcdfDocument::bytes_of(const std::string& name, const NetcdfVariable& variable) const {
  const std::uint64_t all = file_.bytes().size();
  std::uint64_t bytes = podm::verify::size_of(*number_type(variable.type));
  bool fits = variable.begin <= all;
  for (const std::uint64_t size : variable.sizes) {
    if (size > 0 && bytes > all / size) fits = false;
    bytes *= size;
  }
  if (!fits || bytes > all - variable.begin)
    file_.refuse(fmt::format("variable '{}'", name),
                 fmt::format("its values at byte {} run past the end of the file", variable.begin));
  return file_.bytes().substr(variable.begin, bytes);
}

NumberArray NetcdfDocument::numbers(const std::string& name, std::uint64_t count) const {
  const std::string place = fmt::format("variable '{}'", name);
  const NetcdfVariable* variable = find(name);
  if (variable == nullptr) file_.refuse(place, "the file has no such variable");
  if (variable->type == kChar) file_.refuse(place, "holds text, not numbers");
  NumberArray values(bytes_of(name, *variable), *number_type(variable->type), kIsSwapped);
  if (values.size() != count)
    file_.refuse(place, fmt::format("{} values, {} are expected", values.size(), count));
  return values;
}

std::vector<std::string> NetcdfDocument::texts(const std::string& name) const {
  std::vector<std::string> rows;
  const NetcdfVariable* variable = find(name);
  if (variable == nullptr || variable->type != kChar || variable->sizes.size() != 2) return rows;
  std::string_view bytes = bytes_of(name, *variable);
  for (const std::uint64_t width = variable->sizes[1]; width > 0 && !bytes.empty();
       bytes.remove_prefix(width)) {
    const std::string_view row = bytes.substr(0, width);
    rows.emplace_back(row.substr(0, row.find('\0')));
  }
  return rows;
}

}  // namespace podm::verify
