#include "run/mend_turned_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "geometry/affine.h"
#include "geometry/predicates.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr std::size_t kCellsOfRange = 1 << 13;
constexpr int kMostDoublings = 12;  // of a step of one unit in the last place

using Cells = std::vector<std::uint32_t>;

class TurnedCells {
 public:
  TurnedCells(TetMesh& mesh, const LabelImage& image, int threads)
      : mesh_(mesh), threads_(num_threads(threads)) {
    const double flip = mesh.space == Space::kLps ? -1 : 1;
    const Affine& a = image.voxel_to_ras;
    for (std::size_t axis = 0; axis < 3; ++axis)
      axes_[axis] = (1 / image.spacing[axis]) * Vector{flip * a[axis], flip * a[4 + axis], a[8 + axis]};
  }

  std::uint64_t mend() {
    Cells inverted = find([&](std::uint32_t c) { return !is_positive(c); });
    if (inverted.empty()) return 0;
    find_cells_around(inverted);
    find_unit();
    std::ranges::sort(inverted, {}, [&](std::uint32_t c) { return points_of(c); });
    for (const std::uint32_t c : inverted)
      if (!is_positive(c)) mend(c);
    return inverted.size();
  }

 private:
  Point point(std::uint32_t v) const {
    return {mesh_.vertices[v][0], mesh_.vertices[v][1], mesh_.vertices[v][2]};
  }
  // A replay numbers cells and vertices in another order: their points decide which moves are tried first.
  std::array<std::array<double, 3>, 4> points_of(std::uint32_t c) const {
    std::array<std::array<double, 3>, 4> points;
    std::ranges::transform(vertices_of(c), points.begin(),
                           [&](std::uint32_t v) { return mesh_.vertices[v]; });
    return points;
  }
  std::array<std::uint32_t, 4> vertices_of(std::uint32_t c) const {
    std::array<std::uint32_t, 4> vertices = mesh_.cells[c];
    std::ranges::sort(vertices, {}, [&](std::uint32_t v) { return mesh_.vertices[v]; });
    return vertices;
  }
  bool is_positive(std::uint32_t c) const {
    const auto& [u, v, w, x] = mesh_.cells[c];
    return orientation(point(u), point(v), point(w), point(x)) > 0;
  }

  /// The cells for which accept(cell) holds, in ascending order.
  template <class Accept>
  Cells find(const Accept& accept) const {
    Cells found;
    std::mutex mutex;
    parallel_for_ranges(mesh_.cells.size(), kCellsOfRange, threads_,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          Cells here;
                          for (std::size_t c = begin; c < end; ++c)
                            if (accept(static_cast<std::uint32_t>(c)))
                              here.push_back(static_cast<std::uint32_t>(c));
                          const std::lock_guard lock(mutex);
                          found.insert(found.end(), here.begin(), here.end());
                        });
    std::ranges::sort(found);
    return found;
  }

  void find_cells_around(const Cells& inverted) {
    for (const std::uint32_t c : inverted)
      for (const std::uint32_t v : mesh_.cells[c]) cells_around_[v];
    const auto is_around = [&](std::uint32_t v) { return cells_around_.contains(v); };
    for (const std::uint32_t c :
         find([&](std::uint32_t each) { return std::ranges::any_of(mesh_.cells[each], is_around); }))
      for (const std::uint32_t v : mesh_.cells[c])
        if (is_around(v)) cells_around_[v].push_back(c);
  }

  void find_unit() {
    double largest = 0;
    for (const auto& vertex : mesh_.vertices)
      for (const double x : vertex) largest = std::max(largest, std::fabs(x));
    unit_mm_ = largest * std::numeric_limits<double>::epsilon();
  }

  // The circumradius of a flat cell may become anything. The best move is that with the least circumradius.
  void mend(std::uint32_t c) {
    std::optional<Move> best;
    for (int doublings = 0; doublings <= kMostDoublings; ++doublings)
      for (const std::uint32_t v : vertices_of(c))
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const double sign : {-1.0, 1.0}) {
            const auto move = moved(v, axis, std::ldexp(sign * unit_mm_, doublings), c);
            if (move && (!best || move->squared_radius < best->squared_radius)) best = move;
          }
    if (best) mesh_.vertices[best->vertex] = best->to;
  }

  struct Move {
    std::uint32_t vertex;
    std::array<double, 3> to;
    double squared_radius;  // of the inverted cell
  };
  // The move along an axis, if all cells around the vertex are then positive.
  std::optional<Move> moved(std::uint32_t v, std::size_t axis, double step_mm, std::uint32_t inverted) {
    constexpr unsigned kSidesOfAxis = 3;
    if ((mesh_.vertex_sides[v] >> 2 * axis & kSidesOfAxis) != 0) return std::nullopt;
    const Point p = point(v) + step_mm * axes_[axis];
    const std::array<double, 3> before = std::exchange(mesh_.vertices[v], {p.x, p.y, p.z});
    std::optional<Move> move;
    if (std::ranges::all_of(cells_around_.at(v), [&](std::uint32_t c) { return is_positive(c); }))
      move = {v, mesh_.vertices[v], squared_radius(inverted)};
    mesh_.vertices[v] = before;
    return move;
  }
  double squared_radius(std::uint32_t c) const {
    const auto& [u, v, w, x] = mesh_.cells[c];
    return squared_distance(exact_circumcenter(point(u), point(v), point(w), point(x)), point(u));
  }

  TetMesh& mesh_;
  std::size_t threads_;
  std::array<Vector, 3> axes_;  // of the image, unit vectors in the mesh's space
  std::map<std::uint32_t, Cells> cells_around_;
  double unit_mm_ = 0;
};

}  // namespace

std::uint64_t mend_turned_cells(TetMesh& mesh, const LabelImage& image, int threads) {
  return TurnedCells(mesh, image, threads).mend();
}

}  // namespace podm
