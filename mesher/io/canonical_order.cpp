// The canonical order of a mesh, in time linear in its cells and with little memory beside it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

using VertexId = std::uint32_t;

// Sorts the vertices by (x, y, z) and returns the new position of each.
std::vector<VertexId> sort_vertices(std::vector<std::array<double, 3>>& vertices) {
  struct Key {
    double x;  // beside the id, so that nearly every comparison stays in the sorted array
    VertexId id;
  };
  std::vector<Key> order(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (double& coordinate : vertices[v]) {
      if (!std::isfinite(coordinate))
        throw InternalError("a mesh vertex has a coordinate that is not finite");
      coordinate += 0.0;  // -0 becomes 0: equal coordinates have equal bytes
    }
    order[v] = {vertices[v][0], static_cast<VertexId>(v)};
  }
  std::sort(order.begin(), order.end(), [&](const Key& a, const Key& b) {
    if (a.x != b.x) return a.x < b.x;
    return vertices[a.id] < vertices[b.id];
  });

  std::vector<std::array<double, 3>> sorted(vertices.size());
  std::vector<VertexId> position(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    sorted[v] = vertices[order[v].id];
    position[order[v].id] = static_cast<VertexId>(v);
  }
  vertices.swap(sorted);
  return position;
}

// The even permutations of four vertices fall into two classes; the representative is ascending, or
// ascending with its last two swapped.
void permute_evenly(std::array<VertexId, 4>& cell) {
  bool odd = false;
  const auto order = [&](int i, int j) {
    if (cell[i] > cell[j]) {
      std::swap(cell[i], cell[j]);
      odd = !odd;
    }
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
  if (odd) std::swap(cell[2], cell[3]);
}

void permute_evenly(std::array<VertexId, 3>& facet) {
  std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
}

// Sorts simplices and their labels in place: an American flag pass (McIlroy, Bostic, McIlroy, "Engineering
// radix sort", 1993) on the leading bits of the first vertex, then each bucket, small enough for the cache,
// by counting its first vertices and sorting the few simplices that share one.
template <std::size_t N, class SimplexLabel>
class SimplexSorter {
 public:
  SimplexSorter(std::vector<std::array<VertexId, N>>& simplices, std::vector<SimplexLabel>& labels,
                std::size_t num_vertices)
      : simplices_(simplices),
        labels_(labels),
        bucket_bits_(std::max(0, static_cast<int>(std::bit_width(num_vertices)) - kLeadingBits)),
        bucket_begin_((num_vertices >> bucket_bits_) + 2) {}

  void sort() {
    distribute();
    for (std::size_t b = 0; b + 1 < bucket_begin_.size(); ++b) sort_bucket(b);
  }

 private:
  static constexpr int kLeadingBits = 10;
  struct Record {
    std::array<VertexId, N> simplex;
    SimplexLabel label;
    auto operator<=>(const Record&) const = default;
  };

  std::size_t bucket_of(const std::array<VertexId, N>& simplex) const { return simplex[0] >> bucket_bits_; }

  void distribute() {
    for (const auto& simplex : simplices_) ++bucket_begin_[bucket_of(simplex) + 1];
    std::partial_sum(bucket_begin_.begin(), bucket_begin_.end(), bucket_begin_.begin());
    std::vector<std::size_t> next = bucket_begin_;
    for (std::size_t b = 0; b + 1 < bucket_begin_.size(); ++b) {
      while (next[b] < bucket_begin_[b + 1]) {
        const std::size_t home = bucket_of(simplices_[next[b]]);
        if (home != b) {
          std::swap(simplices_[next[b]], simplices_[next[home]]);
          std::swap(labels_[next[b]], labels_[next[home]]);
        }
        ++next[home];
      }
    }
  }

  void sort_bucket(std::size_t bucket) {
    const std::size_t begin = bucket_begin_[bucket], size = bucket_begin_[bucket + 1] - begin;
    const VertexId first_vertex = static_cast<VertexId>(bucket << bucket_bits_);
    run_begin_.assign((std::size_t{1} << bucket_bits_) + 1, 0);
    records_.resize(size);
    for (std::size_t i = begin; i < begin + size; ++i) ++run_begin_[simplices_[i][0] - first_vertex + 1];
    std::partial_sum(run_begin_.begin(), run_begin_.end(), run_begin_.begin());
    for (std::size_t i = begin; i < begin + size; ++i)  // leaves run_begin_ one run ahead
      records_[run_begin_[simplices_[i][0] - first_vertex]++] = {simplices_[i], labels_[i]};
    std::size_t run = 0;
    for (const std::size_t run_end : run_begin_) {
      std::sort(records_.begin() + run, records_.begin() + run_end);
      run = run_end;
    }
    for (std::size_t i = 0; i < size; ++i) {
      simplices_[begin + i] = records_[i].simplex;
      labels_[begin + i] = records_[i].label;
    }
  }

  std::vector<std::array<VertexId, N>>& simplices_;
  std::vector<SimplexLabel>& labels_;
  int bucket_bits_;                        // of the first vertex that tell simplices of one bucket apart
  std::vector<std::size_t> bucket_begin_;  // one more than buckets
  std::vector<std::size_t> run_begin_;     // scratch: simplices of a bucket by first vertex
  std::vector<Record> records_;            // scratch: one bucket
};

template <std::size_t N, class SimplexLabel>
void sort_simplices(std::vector<std::array<VertexId, N>>& simplices, std::vector<SimplexLabel>& labels,
                    const std::vector<VertexId>& position) {
  for (auto& simplex : simplices) {
    for (VertexId& vertex : simplex) vertex = position[vertex];
    permute_evenly(simplex);
  }
  SimplexSorter<N, SimplexLabel>(simplices, labels, position.size()).sort();
}

}  // namespace

void canonicalize(TetMesh& mesh) {
  const std::vector<VertexId> position = sort_vertices(mesh.vertices);
  sort_simplices(mesh.cells, mesh.cell_labels, position);
  sort_simplices(mesh.facets, mesh.facet_labels, position);
}

}  // namespace podm
