// Computes the canonical order of a mesh, in time nearly linear in its cells, on all threads. Vertices are
// grouped into buckets of x, cells and facets into buckets of their first vertex. Each bucket is sorted in a
// cache.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "io/buckets.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

using VertexId = std::uint32_t;

// Replaces -0 by 0, so that equal coordinates have equal bytes. Returns the bounds of x.
std::array<double, 2> normalize(std::vector<std::array<double, 3>>& vertices) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (auto& vertex : vertices) {
    for (double& coordinate : vertex) {
      if (!std::isfinite(coordinate))
        throw InternalError("a mesh vertex has a coordinate that is not finite");
      coordinate += 0.0;
    }
    low = std::min(low, vertex[0]);
    high = std::max(high, vertex[0]);
  }
  return {low, high};
}

// Sorts the vertices by (x, y, z) and returns the new position of each vertex.
std::vector<VertexId> sort_vertices(std::vector<std::array<double, 3>>& vertices, std::size_t threads) {
  struct Key {
    double x;  // stored beside the id, so that nearly every comparison stays in the bucket
    VertexId id;
  };
  constexpr std::size_t kVerticesPerBucket = 32, kMostBuckets = 1 << 14;
  const auto [low, high] = normalize(vertices);
  const std::size_t num_buckets = std::min(kMostBuckets, vertices.size() / kVerticesPerBucket + 1);
  // Rounding keeps the order: the larger of two numbers is never in a lower bucket.
  const double width = 0.5 * high - 0.5 * low;
  const double scale = width > 0 ? std::min(1e300, static_cast<double>(num_buckets - 1) / width) : 0;
  const auto bucket_of = [&, low = low](double x) {
    return static_cast<std::size_t>((0.5 * x - 0.5 * low) * scale);
  };
  Buckets<Key> buckets(
      vertices.size(), num_buckets, threads,
      [&](std::size_t v, std::size_t) { return bucket_of(vertices[v][0]); },
      [&](std::size_t v) {
        return Key{vertices[v][0], static_cast<VertexId>(v)};
      },
      [&](const Key& key) { return bucket_of(key.x); });

  std::vector<std::array<double, 3>> sorted(vertices.size());
  std::vector<VertexId> position(vertices.size());
  parallel_for(num_buckets, threads, [&](std::size_t b, std::size_t) {
    const auto keys = buckets[b];
    std::sort(keys.begin(), keys.end(), [&](const Key& a, const Key& c) {
      if (a.x != c.x) return a.x < c.x;
      return vertices[a.id] < vertices[c.id];
    });
    std::size_t at = buckets.begin(b);
    for (const Key& key : keys) {
      sorted[at] = vertices[key.id];
      position[key.id] = static_cast<VertexId>(at++);
    }
  });
  vertices.swap(sorted);
  return position;
}

// Puts the smaller vertex first and returns whether the two were swapped. Has no branch, because the branch
// would be unpredictable.
std::uint32_t put_in_order(VertexId& a, VertexId& b) {
  const std::uint32_t is_swapped = a > b;
  const VertexId change = (a ^ b) & (0u - is_swapped);
  a ^= change;
  b ^= change;
  return is_swapped;
}

// The permutations of four vertices fall into two classes under even permutations. The representative is
// ascending, or ascending with its last two vertices swapped.
void permute_evenly(std::array<VertexId, 4>& cell) {
  auto [a, b, c, d] = cell;
  std::uint32_t swaps = put_in_order(a, b);
  swaps ^= put_in_order(c, d);
  swaps ^= put_in_order(a, c);
  swaps ^= put_in_order(b, d);
  swaps ^= put_in_order(b, c);
  const VertexId change = (c ^ d) & (0u - swaps);
  cell = {a, b, c ^ change, d ^ change};
}

void permute_evenly(std::array<VertexId, 3>& facet) {
  std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
}

// A number that orders simplices with the same first vertex: by the other vertices, then by label. Comparing
// single numbers takes no branch.
using Key = unsigned __int128;

LabelIndex label_bits(LabelIndex label) { return label; }
std::uint32_t label_bits(const std::array<LabelIndex, 2>& pair) {
  return std::uint32_t{pair[0]} << 16 | pair[1];
}
void set_label(LabelIndex& label, std::uint32_t bits) { label = static_cast<LabelIndex>(bits); }
void set_label(std::array<LabelIndex, 2>& pair, std::uint32_t bits) {
  pair = {static_cast<LabelIndex>(bits >> 16), static_cast<LabelIndex>(bits)};
}

// Sorts a few keys. Each key finds its place by counting the smaller keys, without unpredictable branches.
void sort_few(std::span<const Key> keys, Key* sorted) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::size_t place = 0;
    for (std::size_t j = 0; j < i; ++j) place += keys[j] <= keys[i];
    for (std::size_t j = i + 1; j < keys.size(); ++j) place += keys[j] < keys[i];
    sorted[place] = keys[i];
  }
}

// Sorts simplices and their labels. The buckets are given by the leading bits of the first vertex.
template <std::size_t N, class SimplexLabel>
class SimplexSorter {
 public:
  SimplexSorter(std::vector<std::array<VertexId, N>>& simplices, std::vector<SimplexLabel>& labels,
                const std::vector<VertexId>& position, std::size_t threads)
      : simplices_(simplices),
        labels_(labels),
        position_(position),
        threads_(threads),
        bucket_bits_(std::max(0, static_cast<int>(std::bit_width(position.size())) - kLeadingBits)) {}

  void sort() {
    Buckets<Record> buckets(
        simplices_.size(), (position_.size() >> bucket_bits_) + 1, threads_,
        [&](std::size_t i, std::size_t end) {  // another thread renumbers the simplices from `end` on
          for (const VertexId v : simplices_[std::min(i + kLookahead, end - 1)])
            __builtin_prefetch(&position_[v]);
          return renumber(simplices_[i]) >> bucket_bits_;
        },
        [&](std::size_t i) {
          return Record{simplices_[i], label_bits(labels_[i])};
        },
        [&](const Record& record) { return record.simplex[0] >> bucket_bits_; });
    const Workspace empty{std::vector<std::size_t>((std::size_t{1} << bucket_bits_) + 1),
                          std::vector<Key>(buckets.largest()),
                          {}};
    std::vector<Workspace> workspaces(threads_, empty);
    parallel_for(buckets.size(), threads_, [&](std::size_t b, std::size_t thread) {
      sort_bucket(buckets[b], static_cast<VertexId>(b << bucket_bits_), buckets.begin(b), workspaces[thread]);
    });
  }

 private:
  static constexpr int kLeadingBits = 10;
  // Number of simplices whose vertices' positions are prefetched.
  static constexpr std::size_t kLookahead = 16;
  static constexpr std::size_t kFew = 40;  // limit of sort_few(): simplices with the same first vertex
  struct Record {
    std::array<VertexId, N> simplex;
    std::uint32_t label;
  };
  struct Workspace {
    std::vector<std::size_t> run_end;  // one per vertex of the bucket
    std::vector<Key> keys;
    std::array<Key, kFew> few;
  };

  // Renumbers and permutes the vertices of the simplex. Returns the first one.
  VertexId renumber(std::array<VertexId, N>& simplex) const {
    for (VertexId& vertex : simplex) vertex = position_[vertex];
    permute_evenly(simplex);
    return simplex[0];
  }

  static Key key_of(const Record& record) {
    Key key = 0;
    for (std::size_t i = 1; i < N; ++i) key = key << 32 | record.simplex[i];
    return key << 32 | record.label;
  }

  // Counts the simplices by first vertex, then sorts those with the same first vertex.
  void sort_bucket(std::span<const Record> records, VertexId first_vertex, std::size_t begin,
                   Workspace& work) {
    std::fill(work.run_end.begin(), work.run_end.end(), 0);
    for (const Record& record : records) ++work.run_end[record.simplex[0] - first_vertex + 1];
    std::partial_sum(work.run_end.begin(), work.run_end.end(), work.run_end.begin());
    for (const Record& record : records)  // moves the begin of each run to its end
      work.keys[work.run_end[record.simplex[0] - first_vertex]++] = key_of(record);
    std::size_t at = 0;
    for (std::size_t v = 0; at < records.size(); ++v) {
      const std::span<Key> run(work.keys.data() + at, work.run_end[v] - at);
      write(static_cast<VertexId>(first_vertex + v), sorted(run, work), begin + at);
      at = work.run_end[v];
    }
  }

  static std::span<const Key> sorted(std::span<Key> run, Workspace& work) {
    if (run.size() > kFew) {
      std::sort(run.begin(), run.end());
      return run;
    }
    sort_few(run, work.few.data());
    return {work.few.data(), run.size()};
  }

  void write(VertexId first_vertex, std::span<const Key> run, std::size_t at) {
    for (const Key key : run) {
      auto& simplex = simplices_[at];
      simplex[0] = first_vertex;
      for (std::size_t i = 1; i < N; ++i) simplex[i] = static_cast<VertexId>(key >> (32 * (N - i)));
      set_label(labels_[at++], static_cast<std::uint32_t>(key));
    }
  }

  std::vector<std::array<VertexId, N>>& simplices_;
  std::vector<SimplexLabel>& labels_;
  const std::vector<VertexId>& position_;
  std::size_t threads_;
  int bucket_bits_;  // low bits of the first vertex, which distinguish simplices of one bucket
};

// Renumbers the vertices of the edges. Sorts the lines by their labels, and the edges by their vertices.
void sort_lines(MeshLines& lines, const std::vector<VertexId>& position) {
  std::vector<std::uint32_t> order(lines.labels_of_line.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t line) { return lines.labels_of_line[line]; });
  std::vector<std::uint32_t> place(order.size());
  std::vector<std::vector<LabelIndex>> labels;
  for (const std::uint32_t line : order) {
    place[line] = static_cast<std::uint32_t>(labels.size());
    labels.push_back(std::move(lines.labels_of_line[line]));
  }
  lines.labels_of_line.swap(labels);
  std::vector<std::pair<std::array<VertexId, 2>, std::uint32_t>> edges;
  edges.reserve(lines.edges.size());
  for (std::size_t e = 0; e < lines.edges.size(); ++e) {
    std::array<VertexId, 2> edge{position[lines.edges[e][0]], position[lines.edges[e][1]]};
    put_in_order(edge[0], edge[1]);
    edges.emplace_back(edge, place[lines.line_of_edge[e]]);
  }
  std::ranges::sort(edges);
  for (std::size_t e = 0; e < edges.size(); ++e) std::tie(lines.edges[e], lines.line_of_edge[e]) = edges[e];
}

}  // namespace

void canonicalize(TetMesh& mesh, int threads) {
  const std::size_t used = num_threads(threads);
  const std::vector<VertexId> position = sort_vertices(mesh.vertices, used);
  if (!mesh.vertex_sides.empty()) {
    const std::vector<SideMask> sides = mesh.vertex_sides;
    for (std::size_t v = 0; v < sides.size(); ++v) mesh.vertex_sides[position[v]] = sides[v];
  }
  SimplexSorter(mesh.cells, mesh.cell_labels, position, used).sort();
  SimplexSorter(mesh.facets, mesh.facet_labels, position, used).sort();
  sort_lines(mesh.lines, position);
}

}  // namespace podm
