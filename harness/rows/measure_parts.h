// The lists of measures that measures() joins, and functions that several of the lists use.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "rows/measure.h"

namespace podm::bench {

std::span<const Measure> measures_of_time();
std::span<const Measure> measures_of_ranks();
std::span<const Measure> measures_of_losses();
std::span<const Measure> measures_of_mesh();

inline constexpr auto kLess = Better::kLess, kMore = Better::kMore;
using enum Meaning;

inline Value absent(const std::string& why) { return {{}, why}; }

/// Returns the number at a place, or the reason why rows have none.
template <class T>
Value number_or_reason(const std::optional<T>& number, const char* place) {
  if (!number) return absent(std::string("rows have no ") + place);
  return {static_cast<double>(*number), ""};
}

/// Returns a member of a part of the mesher's record; both may be absent.
template <class Part, class T>
Value of_mesh(const Row& row, std::optional<Part> MeshRecord::*part, std::optional<T> Part::*member,
              const char* place) {
  const bool is_there = row.mesh && *row.mesh.*part;
  return number_or_reason(is_there ? *(*row.mesh.*part).*member : std::optional<T>(), place);
}

Value sum_of(const ByName<std::uint64_t>& parts);
Value quotient(const Value& dividend, const Value& divisor);
Value cells(const Row& row);

}  // namespace podm::bench
