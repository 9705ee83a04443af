// An array of numbers in the type and byte order of its file.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "mesh.h"
#include "readers/byte_buffer.h"

namespace podm::verify {

enum class NumberType : std::uint8_t {
  kInt8,
  kUInt8,
  kInt16,
  kUInt16,
  kInt32,
  kUInt32,
  kInt64,
  kUInt64,
  kFloat32,
  kFloat64
};

/// Calls visit(Number{}), where Number is the C++ type.
template <class Visit>
decltype(auto) with_number_type(NumberType type, Visit visit) {
  switch (type) {
    case NumberType::kInt8:
      return visit(std::int8_t{});
    case NumberType::kUInt8:
      return visit(std::uint8_t{});
    case NumberType::kInt16:
      return visit(std::int16_t{});
    case NumberType::kUInt16:
      return visit(std::uint16_t{});
    case NumberType::kInt32:
      return visit(std::int32_t{});
    case NumberType::kUInt32:
      return visit(std::uint32_t{});
    case NumberType::kInt64:
      return visit(std::int64_t{});
    case NumberType::kUInt64:
      return visit(std::uint64_t{});
    case NumberType::kFloat32:
      return visit(float{});
    case NumberType::kFloat64:
      break;
  }
  return visit(double{});
}

inline std::size_t size_of(NumberType type) {
  return with_number_type(type, [](auto number) { return sizeof(number); });
}

/// Returns the number whose bytes start at `bytes`, swapped if the file's byte order is not this machine's.
template <class Number>
Number load_number(const char* bytes, bool is_swapped) {
  std::array<char, sizeof(Number)> copy;
  std::memcpy(copy.data(), bytes, sizeof(Number));
  if (is_swapped)
    for (std::size_t i = 0; i < sizeof(Number) / 2; ++i) std::swap(copy[i], copy[sizeof(Number) - 1 - i]);
  return std::bit_cast<Number>(copy);
}

/// Returns the integer that equals `number`; none for a fraction, NaN, infinity or a value beyond 64 bits.
template <class Number>
std::optional<std::int64_t> exact_integer(Number number) {
  if constexpr (std::is_floating_point_v<Number>) {
    constexpr Number kLimit = 9223372036854775808.0;  // 2^63
    if (!(number >= -kLimit && number < kLimit)) return std::nullopt;
    const auto integer = static_cast<std::int64_t>(number);
    if (static_cast<Number>(integer) != number) return std::nullopt;
    return integer;
  } else {
    if (!std::in_range<std::int64_t>(number)) return std::nullopt;
    return static_cast<std::int64_t>(number);
  }
}

class NumberArray {
 public:
  NumberArray() = default;
  /// The bytes must outlive the array.
  NumberArray(std::string_view bytes, NumberType type, bool is_swapped)
      : bytes_(bytes), type_(type), is_swapped_(is_swapped) {}
  NumberArray(ByteBuffer bytes, NumberType type, bool is_swapped)
      : owned_(std::move(bytes)), bytes_(owned_.view()), type_(type), is_swapped_(is_swapped) {}

  std::size_t size() const { return bytes_.size() / size_of(type_); }
  double real(std::size_t i) const {
    return with_number_type(type_, [&](auto type) { return static_cast<double>(load<decltype(type)>(i)); });
  }
  std::optional<std::int64_t> integer(std::size_t i) const {
    return with_number_type(type_, [&](auto type) { return exact_integer(load<decltype(type)>(i)); });
  }

 private:
  template <class Number>
  Number load(std::size_t i) const {
    return load_number<Number>(bytes_.data() + i * sizeof(Number), is_swapped_);
  }

  ByteBuffer owned_;
  std::string_view bytes_;
  NumberType type_ = NumberType::kUInt8;
  bool is_swapped_ = false;
};

/// An array with its name and its number of components per tuple in the file.
struct NamedArray {
  std::string name;
  std::size_t num_components = 1;
  NumberArray values;
};

inline constexpr GlobalId kNoId = std::numeric_limits<GlobalId>::max();  ///< no vertex of any mesh
/// Returns the id, kNoId for a number that cannot be one.
inline GlobalId global_id(std::optional<std::int64_t> id) {
  return id && *id >= 0 ? static_cast<GlobalId>(*id) : kNoId;
}
/// Returns the id as Mesh stores it: kNone for a number that cannot be a vertex of a mesh in memory.
inline VertexId vertex_id(std::optional<std::int64_t> id) {
  return id && *id >= 0 && *id < std::int64_t{kNone} ? static_cast<VertexId>(*id) : kNone;
}

}  // namespace podm::verify
