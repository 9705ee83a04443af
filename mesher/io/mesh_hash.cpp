// The order-independent hash of a mesh. podm/mesh_io.h defines it.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "podm/mesh_io.h"
#include "runtime/mix.h"
#include "runtime/parallel_for.h"

namespace podm {
namespace {

constexpr std::size_t kChunk = 1 << 13;
constexpr std::uint64_t kCell = 1, kFacet = 2;  // first values of the hashes of cells and facets

// Adds a number to a hash. The numbers are random themselves, so a final mix() after the last one suffices.
std::uint64_t combine(std::uint64_t hash, std::uint64_t more) { return hash * 0x9e3779b97f4a7c15u + more; }

std::uint64_t hash_of(const std::array<double, 3>& vertex) {
  std::uint64_t hash = 0;
  for (const double x : vertex)
    hash = mix(combine(hash, std::bit_cast<std::uint64_t>(x + 0.0)));  // x + 0.0 replaces -0 by 0
  return hash;
}

// Returns a hash without the final mix(). It is the same for simplices that are equal up to an even
// permutation of their vertices.
template <std::size_t kVertices>
std::uint64_t hash_of(std::uint64_t hash, const std::array<std::uint32_t, kVertices>& simplex,
                      const std::vector<std::uint64_t>& hash_of_vertex) {
  std::array<std::uint64_t, kVertices> sorted;
  for (std::size_t i = 0; i < kVertices; ++i) sorted[i] = hash_of_vertex[simplex[i]];
  bool is_odd = false;
  for (std::size_t last = kVertices - 1; last > 0; --last) {
    // Without a branch, because every second one would be mispredicted.
    for (std::size_t i = 0; i < last; ++i) {
      const std::uint64_t a = sorted[i], b = sorted[i + 1];
      is_odd ^= b < a;
      sorted[i] = std::min(a, b);
      sorted[i + 1] = std::max(a, b);
    }
  }
  for (const std::uint64_t of_vertex : sorted) hash = combine(hash, of_vertex);
  return combine(hash, is_odd ? 1 : 0);
}

// Returns the sum of hash(i) for all i < count.
template <class Hash>
std::uint64_t sum_of(std::size_t count, std::size_t threads, const Hash& hash) {
  std::atomic<std::uint64_t> sum = 0;
  parallel_for_ranges(count, kChunk, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    std::uint64_t of_chunk = 0;
    for (std::size_t i = begin; i < end; ++i) of_chunk += hash(i);
    sum += of_chunk;
  });
  return sum;
}

}  // namespace

std::uint64_t mesh_hash(const TetMesh& mesh, int threads) {
  const std::size_t num = num_threads(threads);
  std::vector<std::uint64_t> hash_of_vertex(mesh.vertices.size());
  parallel_for_ranges(mesh.vertices.size(), kChunk, num,
                      [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t v = begin; v < end; ++v)
                          hash_of_vertex[v] = hash_of(mesh.vertices[v]);
                      });
  const std::uint64_t of_cells = sum_of(mesh.cells.size(), num, [&](std::size_t c) {
    const std::uint64_t hash = hash_of(kCell, mesh.cells[c], hash_of_vertex);
    return mix(combine(hash, mesh.labels[mesh.cell_labels[c]].value));
  });
  const std::uint64_t of_facets = sum_of(mesh.facets.size(), num, [&](std::size_t f) {
    std::uint64_t hash = hash_of(kFacet, mesh.facets[f], hash_of_vertex);
    for (const LabelIndex label : mesh.facet_labels[f]) hash = combine(hash, mesh.labels[label].value);
    return mix(hash);
  });
  return of_cells + of_facets;
}

std::string mesh_hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace podm
