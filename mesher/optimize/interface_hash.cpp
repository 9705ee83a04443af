#include "optimize/interface_hash.h"

#include <array>
#include <utility>

namespace podm {

namespace {

// Mixes like SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
constexpr std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

// Returns a hash with the sign of the order in which the facet has its vertices.
std::uint64_t signed_hash(std::array<VertexId, 3> v) {
  bool is_odd = false;
  const auto sort = [&](VertexId& a, VertexId& b) {
    if (a < b) return;
    std::swap(a, b);
    is_odd = !is_odd;
  };
  sort(v[0], v[1]);
  sort(v[1], v[2]);
  sort(v[0], v[1]);
  const std::uint64_t hash = mixed((std::uint64_t{v[0]} << 32 | v[1]) + mixed(v[2]));
  return is_odd ? -hash : hash;
}

}  // namespace

std::uint64_t share_of_interface_hash(const Mesh& mesh, CellId c, LabelIndex label) {
  if (label == kBackground) return 0;
  const auto& v = mesh.cell(c).vertices;
  std::uint64_t sum = 0;
  for (const auto& [i, j, k] : kFacetVertices)
    sum +=
        signed_hash({v[static_cast<unsigned>(i)], v[static_cast<unsigned>(j)], v[static_cast<unsigned>(k)]});
  return mixed(label) * sum;
}

}  // namespace podm
