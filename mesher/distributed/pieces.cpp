#include "distributed/pieces.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "distributed/cell_marks.h"
#include "distributed/messages.h"
#include "geometry/point_hash.h"
#include "podm/errors.h"
#include "run/extract_mesh.h"
#include "runtime/parallel_collect.h"
#include "runtime/shared_word.h"

namespace podm {

namespace {

// The number of a vertex in the whole mesh, and the rank whose piece counts it.
struct Number {
  std::uint64_t id;
  std::int64_t owner;
};

class PieceOfMesh {
 public:
  PieceOfMesh(DistributedRefinement& refined, const Isosurface& isosurface, Space space, int threads,
              Communication& ranks)
      : refined_(refined),
        mesh_(*refined.refinement.mesh),
        isosurface_(isosurface),
        space_(space),
        threads_(num_threads(threads)),
        ranks_(ranks) {}

  std::uint64_t count_cells() {
    choose_cells();
    std::array<std::uint64_t, 1> cells{
        static_cast<std::uint64_t>(std::count(is_own_cell_.begin(), is_own_cell_.end(), std::uint8_t{1}))};
    ranks_.sum(cells);
    return cells[0];
  }

  MeshPiece operator()(std::uint64_t& facets_off_isosurface) {
    choose_cells();
    MeshPiece piece;
    piece.rank = ranks_.rank();
    piece.num_pieces = ranks_.size();
    number_vertices(piece);
    // Frees memory first, because extraction takes the most.
    own_numbers_ = std::vector<std::uint64_t>();
    is_used_ = is_own_vertex_ = std::vector<std::uint8_t>();
    const auto is_chosen = [this](CellId c) { return is_own_cell_[c] != 0; };
    piece.mesh = extract_mesh(mesh_, isosurface_, space_, static_cast<int>(threads_), facets_off_isosurface,
                              is_chosen);
    std::tie(piece.first_cell, piece.total_cells) = sums_of(piece.mesh.cells.size());
    std::tie(piece.first_facet, piece.total_facets) = sums_of(piece.mesh.facets.size());
    return piece;
  }

 private:
  int rank_of(const Point& p) const { return refined_.blocks.of(refined_.grid.place_of(p)); }

  // Returns the sum of the counts of the ranks before this one, and the sum of all counts.
  std::pair<std::uint64_t, std::uint64_t> sums_of(std::uint64_t count) const {
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(ranks_.size()));
    counts[static_cast<std::size_t>(ranks_.rank())] = count;
    ranks_.sum(counts);
    const auto own = counts.begin() + ranks_.rank();
    return {std::accumulate(counts.begin(), own, std::uint64_t{0}),
            std::accumulate(counts.begin(), counts.end(), std::uint64_t{0})};
  }

  // Calls visit(id) for the ids below `bound`, on all threads.
  template <class Visit>
  void in_parallel(std::size_t bound, const Visit& visit) const {
    parallel_for_ranges(bound, kLength, threads_, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i) visit(static_cast<std::uint32_t>(i));
    });
  }

  // Makes the centers and labels of shared cells equal on all ranks. This rank reads cells with a vertex in
  // its part of space, and their neighbours. If another rank reads such a cell, too, then the cell has
  // vertices of both parts, or a neighbour of it has: a cell and its neighbour share three vertices.
  void agree_on_centers() {
    CellMarks marks(mesh_.cell_bound());
    in_parallel(mesh_.cell_bound(), [&](CellId c) {
      if (mesh_.cell(c).is_alive() && is_mixed(c)) marks.mark_with_neighbors(c, mesh_);
    });
    const std::vector<CellId> shared = marks.cells(threads_);
    in_parallel(shared.size(), [&](std::uint32_t i) { mesh_.make_canonical(shared[i]); });
  }

  int num_own_vertices(CellId c) const {
    int count = 0;
    for (const VertexId v : mesh_.cell(c).vertices) count += is_own_vertex_[v];
    return count;
  }
  bool is_mixed(CellId c) const {
    const int num_own = num_own_vertices(c);
    return num_own > 0 && num_own < 4;
  }

  // Returns true if this rank owns the cell. A cell belongs to the rank that owns its least vertex.
  bool is_own(CellId c) const {
    const int num_own = num_own_vertices(c);
    if (num_own == 0 || num_own == 4) return num_own == 4;
    const auto& vertices = mesh_.cell(c).vertices;
    return is_own_vertex_[*std::min_element(vertices.begin(), vertices.end(), [&](VertexId a, VertexId b) {
             return lexicographically_less(mesh_.point(a), mesh_.point(b));
           })] != 0;
  }

  // Labels the cells, and chooses those that this rank owns.
  void choose_cells() {
    const CubeRange block = refined_.blocks.range_of(ranks_.rank());
    is_own_vertex_.resize(mesh_.vertex_bound());
    in_parallel(mesh_.vertex_bound(), [&](std::uint32_t v) {
      is_own_vertex_[v] = block.has(refined_.grid.place_of(mesh_.point(v)));
    });
    agree_on_centers();
    label_cells(mesh_, isosurface_, static_cast<int>(threads_));
    is_own_cell_.assign(mesh_.cell_bound(), 0);
    is_used_.assign(mesh_.vertex_bound(), 0);
    in_parallel(mesh_.cell_bound(), [&](CellId c) {
      if (mesh_.label(c) == kBackground || !is_own(c)) return;
      is_own_cell_[c] = 1;
      // Relaxed: all threads write the same value, which is read after they end.
      for (const VertexId v : mesh_.cell(c).vertices)
        store(is_used_[v], std::uint8_t{1}, std::memory_order_relaxed);
    });
  }

  // A used vertex of another rank's part of space, and its place among the used vertices.
  struct Foreign {
    std::size_t place;
    VertexId vertex;
    std::size_t rank;
  };

  // Numbers the vertices used here, in the order of their ids. The rank whose part of space holds a vertex
  // numbers it if this or another rank uses it. The other ranks request the number by coordinates.
  void number_vertices(MeshPiece& piece) {
    const auto used = parallel_collect<VertexId>(
        is_used_.size(), threads_, [&](std::size_t begin, std::size_t end, std::vector<VertexId>& found) {
          for (auto v = static_cast<VertexId>(begin); v < end; ++v)
            if (is_used_[v] != 0) found.push_back(v);
        });
    const auto foreign = parallel_collect<Foreign>(
        used.size(), threads_, [&](std::size_t begin, std::size_t end, std::vector<Foreign>& found) {
          for (std::size_t i = begin; i < end; ++i)
            if (const VertexId v = used[i]; is_own_vertex_[v] == 0)
              found.push_back({i, v, static_cast<std::size_t>(rank_of(mesh_.point(v)))});
        });
    std::vector<std::vector<Point>> wanted(static_cast<std::size_t>(ranks_.size()));
    for (const Foreign& one : foreign) wanted[one.rank].push_back(mesh_.point(one.vertex));
    const std::vector<Bytes> asked = ranks_.all_to_all(messages_of(wanted));
    const ByPoint<Number> number_of = number_own(asked);
    std::vector<std::vector<Number>> answers(asked.size());
    for (std::size_t rank = 0; rank < asked.size(); ++rank)
      for (const Point& p : values_of<Point>(asked[rank])) answers[rank].push_back(number_of.at(p));
    std::vector<std::vector<Number>> numbers;
    for (const Bytes& message : ranks_.all_to_all(messages_of(answers)))
      numbers.push_back(values_of<Number>(message));
    piece.vertex_ids.resize(used.size());
    piece.owns_vertex.assign(used.size(), 1);
    in_parallel(used.size(), [&](std::uint32_t i) { piece.vertex_ids[i] = own_numbers_[used[i]]; });
    std::vector<std::size_t> next(numbers.size());
    for (const Foreign& one : foreign) {
      const Number& number = numbers[one.rank][next[one.rank]++];
      piece.vertex_ids[one.place] = number.id;
      piece.owns_vertex[one.place] = number.owner == ranks_.rank();
    }
    piece.total_vertices = total_vertices_;
  }

  // Numbers the vertices of this part of space, and returns the numbers that other ranks request. This rank
  // owns a vertex if it uses it; otherwise the first rank that requests it owns it.
  ByPoint<Number> number_own(const std::vector<Bytes>& asked) {
    ByPoint<Number> number_of;
    for (std::size_t rank = 0; rank < asked.size(); ++rank)
      for (const Point& p : values_of<Point>(asked[rank]))
        number_of.try_emplace(p, Number{kNoNumber, static_cast<std::int64_t>(rank)});
    const auto numbered = parallel_collect<VertexId>(
        mesh_.vertex_bound(), threads_,
        [&](std::size_t begin, std::size_t end, std::vector<VertexId>& found) {
          for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
            if (is_own_vertex_[v] == 0 || mesh_.vertex(v).kind == VertexKind::kUnused) continue;
            if (is_used_[v] != 0 || number_of.contains(mesh_.point(v))) found.push_back(v);
          }
        });
    const auto [first, total] = sums_of(numbered.size());
    total_vertices_ = total;
    own_numbers_.assign(mesh_.vertex_bound(), kNoNumber);
    in_parallel(numbered.size(), [&, first = first](std::uint32_t i) {
      const VertexId v = numbered[i];
      own_numbers_[v] = first + i;
      const auto found = number_of.find(mesh_.point(v));
      if (found == number_of.end()) return;
      found->second.id = own_numbers_[v];
      if (is_used_[v] != 0) found->second.owner = ranks_.rank();
    });
    for (const auto& number : number_of)
      if (number.second.id == kNoNumber)
        throw InternalError("another rank uses a vertex that the rank of its part of space lacks");
    return number_of;
  }

  static constexpr std::uint64_t kNoNumber = ~std::uint64_t{0};
  static constexpr std::size_t kLength = 1 << 12;  // ids that a thread takes at a time

  DistributedRefinement& refined_;
  Mesh& mesh_;
  const Isosurface& isosurface_;
  Space space_;
  std::size_t threads_;
  Communication& ranks_;
  std::vector<std::uint8_t> is_own_vertex_, is_own_cell_, is_used_;  // by id in the store
  std::vector<std::uint64_t> own_numbers_;                           // by id in the store
  std::uint64_t total_vertices_ = 0;
};

}  // namespace

MeshPiece extract_piece(DistributedRefinement& refined, const Isosurface& isosurface, Space space,
                        int threads, Communication& ranks, std::uint64_t& facets_off_isosurface) {
  return PieceOfMesh(refined, isosurface, space, threads, ranks)(facets_off_isosurface);
}

std::uint64_t count_cells(DistributedRefinement& refined, const Isosurface& isosurface, int threads,
                          Communication& ranks) {
  return PieceOfMesh(refined, isosurface, Space::kRas, threads, ranks).count_cells();
}

}  // namespace podm
