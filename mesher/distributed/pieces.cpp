#include "distributed/pieces.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "distributed/messages.h"
#include "extract_mesh.h"
#include "podm/errors.h"

namespace podm {

namespace {

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

class PieceOfMesh {
 public:
  PieceOfMesh(DistributedRefinement& refined, const Isosurface& isosurface, Space space, int threads,
              Communication& ranks)
      : refined_(refined),
        mesh_(*refined.refinement.mesh),
        isosurface_(isosurface),
        space_(space),
        threads_(threads),
        ranks_(ranks) {}

  MeshPiece operator()(std::uint64_t& facets_off_isosurface) {
    label_cells(mesh_, isosurface_, threads_);
    choose_cells();
    MeshPiece piece;
    piece.rank = ranks_.rank();
    piece.num_pieces = ranks_.size();
    number_vertices(piece);
    const auto is_own = [this](CellId c) { return is_own_cell_[c] != 0; };
    piece.mesh = extract_mesh(mesh_, isosurface_, space_, threads_, facets_off_isosurface, is_own);
    std::tie(piece.first_cell, piece.total_cells) = sums_of(piece.mesh.cells.size());
    std::tie(piece.first_facet, piece.total_facets) = sums_of(piece.mesh.facets.size());
    return piece;
  }

 private:
  int rank_of(const Point& p) const { return refined_.rank_of_cube[refined_.grid.cube_at(p)]; }

  // Those of the ranks before this one, and of all.
  std::pair<std::uint64_t, std::uint64_t> sums_of(std::uint64_t count) const {
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(ranks_.size()));
    counts[static_cast<std::size_t>(ranks_.rank())] = count;
    ranks_.sum(counts);
    const auto own = counts.begin() + ranks_.rank();
    return {std::accumulate(counts.begin(), own, std::uint64_t{0}),
            std::accumulate(counts.begin(), counts.end(), std::uint64_t{0})};
  }

  void choose_cells() {
    is_own_cell_.assign(mesh_.cell_bound(), 0);
    is_used_.assign(mesh_.vertex_bound(), 0);
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (mesh_.label(c) == kBackground) continue;
      const auto& vertices = mesh_.cell(c).vertices;
      const VertexId least = *std::min_element(vertices.begin(), vertices.end(), [&](VertexId a, VertexId b) {
        return lexicographically_less(mesh_.point(a), mesh_.point(b));
      });
      if (rank_of(mesh_.point(least)) != ranks_.rank()) continue;
      is_own_cell_[c] = 1;
      for (const VertexId v : vertices) is_used_[v] = 1;
    }
  }

  // A vertex's number in the whole mesh, and whether this piece counts it.
  struct Number {
    std::uint64_t id;
    std::uint64_t is_own;
  };

  // Numbers the vertices in use here, in the order of their ids. Everybody asks the rank in whose block they
  // lie, by coordinates, itself too: what nobody asks for has no number, and who asks first owns it.
  void number_vertices(MeshPiece& piece) {
    std::vector<std::vector<Point>> wanted(static_cast<std::size_t>(ranks_.size()));
    for_each_used([&](VertexId, const Point& p, std::size_t rank) { wanted[rank].push_back(p); });
    std::vector<Bytes> messages(wanted.size());
    for (std::size_t rank = 0; rank < wanted.size(); ++rank)
      if (!wanted[rank].empty()) append(messages[rank], wanted[rank]);
    std::vector<std::vector<Number>> numbers;
    for (const Bytes& told : ranks_.all_to_all(answers(ranks_.all_to_all(std::move(messages)), piece)))
      numbers.push_back(told.empty() ? std::vector<Number>() : MessageReader(told).read<Number>());
    std::vector<std::size_t> next(wanted.size());
    for_each_used([&](VertexId, const Point&, std::size_t rank) {
      const Number& number = numbers[rank][next[rank]++];
      piece.vertex_ids.push_back(number.id);
      piece.owns_vertex.push_back(number.is_own != 0 ? 1 : 0);
    });
  }

  // Calls visit(id, point, rank it belongs to), in the order of ids.
  template <class Visit>
  void for_each_used(const Visit& visit) const {
    for (VertexId v = 0; v < is_used_.size(); ++v)
      if (is_used_[v] != 0) visit(v, mesh_.point(v), static_cast<std::size_t>(rank_of(mesh_.point(v))));
  }

  struct Asked {
    std::uint64_t id;
    std::size_t first_rank;  // that asks
  };

  // Numbers for the vertices that each rank asks for. Tells the piece how many vertices there are.
  std::vector<Bytes> answers(const std::vector<Bytes>& asked, MeshPiece& piece) {
    std::vector<std::vector<Point>> points;
    ByPoint<Asked> number_of;
    for (std::size_t rank = 0; rank < asked.size(); ++rank) {
      points.push_back(asked[rank].empty() ? std::vector<Point>() : MessageReader(asked[rank]).read<Point>());
      for (const Point& p : points[rank]) number_of.emplace(p, Asked{kNoNumber, rank});
    }
    const auto [first, total] = sums_of(number_of.size());
    piece.total_vertices = total;
    std::uint64_t next = first;
    for (VertexId v = 0; v < mesh_.vertex_bound(); ++v) {
      if (mesh_.vertex(v).kind == VertexKind::kUnused) continue;
      if (const auto found = number_of.find(mesh_.point(v)); found != number_of.end())
        found->second.id = next++;
    }
    if (next != first + number_of.size())
      throw InternalError("another rank has a vertex of this block that is not here");
    std::vector<Bytes> messages(asked.size());
    for (std::size_t rank = 0; rank < asked.size(); ++rank) {
      std::vector<Number> numbers;
      for (const Point& p : points[rank]) {
        const Asked& number = number_of.at(p);
        numbers.push_back({number.id, number.first_rank == rank});
      }
      if (!numbers.empty()) append(messages[rank], numbers);
    }
    return messages;
  }

  static constexpr std::uint64_t kNoNumber = ~std::uint64_t{0};

  DistributedRefinement& refined_;
  Mesh& mesh_;
  const Isosurface& isosurface_;
  Space space_;
  int threads_;
  Communication& ranks_;
  std::vector<std::uint8_t> is_own_cell_, is_used_;  // by id in the store
};

}  // namespace

MeshPiece extract_piece(DistributedRefinement& refined, const Isosurface& isosurface, Space space,
                        int threads, Communication& ranks, std::uint64_t& facets_off_isosurface) {
  return PieceOfMesh(refined, isosurface, space, threads, ranks)(facets_off_isosurface);
}

}  // namespace podm
