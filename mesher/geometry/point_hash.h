// Points as hash keys. The hash uses the bits of the coordinates, with -0 as 0.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "geometry/point.h"

namespace podm {

struct PointHash {
  std::size_t operator()(const Point& p) const {
    std::uint64_t hash = 0;
    for (const double x : {p.x, p.y, p.z})
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
    return hash;
  }
};
template <class Value>
using ByPoint = std::unordered_map<Point, Value, PointHash>;

}  // namespace podm
