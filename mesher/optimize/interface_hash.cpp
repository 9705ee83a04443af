#include "optimize/interface_hash.h"

#include <array>
#include <utility>

#include "runtime/mix.h"

namespace podm {

namespace {

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
  const std::uint64_t hash = mix((std::uint64_t{v[0]} << 32 | v[1]) + mix(v[2]));
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
  return mix(label) * sum;
}

}  // namespace podm
