#include "io/tests/kuhn_mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "geometry/tetrahedron.h"

namespace podm {
namespace {

using Corner = std::array<int, 3>;  // corner of a cube, in grid steps

// Returns the six cells of a cube: monotone paths from (0,0,0) to (1,1,1), permuted to be positively
// oriented.
std::array<std::array<Corner, 4>, 6> cells_of_cube() {
  std::array<std::array<Corner, 4>, 6> cells;
  std::array<int, 3> axes{0, 1, 2};
  for (auto& cell : cells) {
    cell[0] = {0, 0, 0};
    for (int step = 0; step < 3; ++step) {
      cell[step + 1] = cell[step];
      cell[step + 1][axes[step]] = 1;
    }
    const bool even = (axes[1] - axes[0] + 3) % 3 == 1;
    if (!even) std::swap(cell[2], cell[3]);
    std::next_permutation(axes.begin(), axes.end());
  }
  return cells;
}

class KuhnGrid {
 public:
  KuhnGrid(int n, std::uint64_t seed, const std::function<LabelIndex(int, int, int)>& label_of)
      : n_(n), label_of_(label_of), random_(seed), id_of_point_((n + 1) * (n + 1) * (n + 1), kNone) {
    mesh_.labels = {{0, ""}, {7, "liver"}, {3000000000, ""}, {2, "left kidney/2"}};
    const auto cells = cells_of_cube();
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          if (label_at({i, j, k}) != kBackground)
            for (const auto& cell : cells) add_cell({i, j, k}, cell);
  }
  TetMesh take() { return std::move(mesh_); }

 private:
  static constexpr std::uint32_t kNone = ~0u;

  LabelIndex label_at(const Corner& cube) const {
    for (const int c : cube)
      if (c < 0 || c >= n_) return kBackground;
    return label_of_(cube[0], cube[1], cube[2]);
  }

  std::uint32_t vertex_at(const Corner& p) {
    std::uint32_t& id = id_of_point_[(p[2] * (n_ + 1) + p[1]) * (n_ + 1) + p[0]];
    if (id == kNone) {
      id = static_cast<std::uint32_t>(mesh_.vertices.size());
      std::uniform_real_distribution<double> jitter(-0.05, 0.05);
      std::array<double, 3> point;
      for (int axis = 0; axis < 3; ++axis) point[axis] = 0.7 * (p[axis] + jitter(random_)) - 20.3;
      mesh_.vertices.push_back(point);
    }
    return id;
  }

  void add_cell(const Corner& cube, const std::array<Corner, 4>& corners) {
    std::array<std::uint32_t, 4> cell;
    for (int v = 0; v < 4; ++v) {
      cell[v] = vertex_at({cube[0] + corners[v][0], cube[1] + corners[v][1], cube[2] + corners[v][2]});
    }
    const LabelIndex label = label_at(cube);
    mesh_.cells.push_back(cell);
    mesh_.cell_labels.push_back(label);
    for (const auto& facet : kFacetVertices) {
      const LabelIndex beyond = label_beyond(cube, corners, facet);
      if (beyond >= label) continue;  // the cell of the greater label has the facet
      // Orientation as seen from outside.
      mesh_.facets.push_back({cell[facet[0]], cell[facet[2]], cell[facet[1]]});
      mesh_.facet_labels.push_back({beyond, label});
    }
  }

  // Returns the label across a facet: that of the next cube if the facet lies in a side of this one.
  LabelIndex label_beyond(const Corner& cube, const std::array<Corner, 4>& corners,
                          const std::array<int, 3>& facet) const {
    for (int axis = 0; axis < 3; ++axis) {
      const int side = corners[facet[0]][axis];
      if (corners[facet[1]][axis] != side || corners[facet[2]][axis] != side) continue;
      Corner next = cube;
      next[axis] += side == 1 ? 1 : -1;
      return label_at(next);
    }
    return label_at(cube);
  }

  int n_;
  const std::function<LabelIndex(int, int, int)>& label_of_;
  std::mt19937_64 random_;
  std::vector<std::uint32_t> id_of_point_;
  TetMesh mesh_;
};

template <class T>
std::vector<T> reordered(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> result;
  for (const std::uint32_t i : order) result.push_back(values[i]);
  return result;
}

std::vector<std::uint32_t> random_order(std::size_t size, std::mt19937_64& random) {
  std::vector<std::uint32_t> order(size);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

}  // namespace

TetMesh make_kuhn_mesh(int n, std::uint64_t seed, const std::function<LabelIndex(int, int, int)>& label_of) {
  return KuhnGrid(n, seed, label_of).take();
}

TetMesh make_test_mesh(int n, std::uint64_t seed) {
  return make_kuhn_mesh(n, seed, [n](int i, int j, int k) -> LabelIndex {
    if (i + j + k < n / 2) return 0;
    if (std::abs(2 * i - n + 1) + std::abs(2 * j - n + 1) + std::abs(2 * k - n + 1) < n - 1) return 3;
    return 2 * i < n ? 1 : 2;
  });
}

// All labels around an edge are on the sides of the facets around it.
void add_lines(TetMesh& mesh) {
  std::map<std::array<std::uint32_t, 2>, std::set<LabelIndex>> labels_around;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const auto [first, second] = std::minmax(mesh.facets[f][i], mesh.facets[f][(i + 1) % 3]);
      labels_around[{first, second}].insert(mesh.facet_labels[f].begin(), mesh.facet_labels[f].end());
    }
  }
  mesh.lines.delta_mm = 1;
  std::map<std::set<LabelIndex>, std::uint32_t> lines;
  for (const auto& [edge, labels] : labels_around) {
    if (labels.size() < 3) continue;
    const auto [line, is_new] = lines.emplace(labels, static_cast<std::uint32_t>(lines.size()));
    if (is_new) mesh.lines.labels_of_line.emplace_back(labels.begin(), labels.end());
    mesh.lines.edges.push_back(edge);
    mesh.lines.line_of_edge.push_back(line->second);
  }
}

TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  TetMesh result = mesh;
  const auto old_vertex = random_order(mesh.vertices.size(), random);
  result.vertices = reordered(mesh.vertices, old_vertex);
  std::vector<std::uint32_t> new_vertex(old_vertex.size());
  for (std::uint32_t v = 0; v < old_vertex.size(); ++v) new_vertex[old_vertex[v]] = v;

  const auto old_cell = random_order(mesh.cells.size(), random);
  result.cells = reordered(mesh.cells, old_cell);
  result.cell_labels = reordered(mesh.cell_labels, old_cell);
  for (auto& cell : result.cells) {
    for (auto& vertex : cell) vertex = new_vertex[vertex];
    for (int turn = 0; turn < 4; ++turn) {  // three-cycles generate every even permutation
      const auto begin = cell.begin() + random() % 2;
      std::rotate(begin, begin + random() % 3, begin + 3);
    }
  }
  const auto old_facet = random_order(mesh.facets.size(), random);
  result.facets = reordered(mesh.facets, old_facet);
  result.facet_labels = reordered(mesh.facet_labels, old_facet);
  for (auto& facet : result.facets) {
    for (auto& vertex : facet) vertex = new_vertex[vertex];
    std::rotate(facet.begin(), facet.begin() + random() % 3, facet.end());
  }
  const auto old_edge = random_order(mesh.lines.edges.size(), random);
  result.lines.edges = reordered(mesh.lines.edges, old_edge);
  result.lines.line_of_edge = reordered(mesh.lines.line_of_edge, old_edge);
  for (auto& edge : result.lines.edges) {
    const auto [first, second] = std::minmax(new_vertex[edge[0]], new_vertex[edge[1]]);
    edge = {first, second};
  }
  return result;
}

double six_volumes(const std::array<double, 3>& a, const std::array<double, 3>& b,
                   const std::array<double, 3>& c, const std::array<double, 3>& d) {
  std::array<double, 3> u, v, w;
  for (int i = 0; i < 3; ++i) u[i] = b[i] - a[i], v[i] = c[i] - a[i], w[i] = d[i] - a[i];
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
         w[2] * (u[0] * v[1] - u[1] * v[0]);
}

double volume_of_label(const TetMesh& mesh, LabelIndex label) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto [a, b, c, d] = mesh.cells[i];
    const auto& v = mesh.vertices;
    if (mesh.cell_labels[i] == label) sum += six_volumes(v[a], v[b], v[c], v[d]) / 6;
  }
  return sum;
}

bool same_mesh(const TetMesh& a, const TetMesh& b) {
  const auto value = [](const TetMesh& mesh, LabelIndex label) { return mesh.labels[label].value; };
  const auto same_label = [&](LabelIndex x, LabelIndex y) { return value(a, x) == value(b, y); };
  const auto same_pair = [&](const auto& x, const auto& y) {
    return same_label(x[0], y[0]) && same_label(x[1], y[1]);
  };
  const auto same_line = [&](const auto& x, const auto& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), same_label);
  };
  const auto &lines = a.lines.labels_of_line, &other_lines = b.lines.labels_of_line;
  return a.lines.edges == b.lines.edges && a.lines.line_of_edge == b.lines.line_of_edge &&
         std::equal(lines.begin(), lines.end(), other_lines.begin(), other_lines.end(), same_line) &&
         a.vertices == b.vertices && a.cells == b.cells && a.facets == b.facets && a.space == b.space &&
         std::equal(a.cell_labels.begin(), a.cell_labels.end(), b.cell_labels.begin(), b.cell_labels.end(),
                    same_label) &&
         std::equal(a.facet_labels.begin(), a.facet_labels.end(), b.facet_labels.begin(),
                    b.facet_labels.end(), same_pair);
}

}  // namespace podm
