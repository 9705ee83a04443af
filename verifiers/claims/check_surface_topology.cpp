#include "claims/check_surface_topology.h"

#include <algorithm>
#include <numeric>

#include "parallel.h"

namespace podm::verify {

namespace {

// The cells of each vertex, without cells of the background.
struct CellsOfVertex {
  std::vector<std::uint32_t> begin, cells;

  CellsOfVertex(const Mesh& mesh, const CellLabelIndices& label_indices)
      : begin(mesh.vertices.size() + 1, 0) {
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (label_indices.of_cell[c] != 0)
        for (const VertexId v : mesh.cells[c]) ++begin[v];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    cells.resize(begin.back());
    for (std::size_t c = mesh.cells.size(); c-- > 0;)
      if (label_indices.of_cell[c] != 0)
        for (const VertexId v : mesh.cells[c]) cells[--begin[v]] = static_cast<std::uint32_t>(c);
  }
};

// Adds the vertex, and the edges to vertices of greater id, once for each label that has them.
class LinkCounter {
 public:
  LinkCounter(const Mesh& mesh, const CellLabelIndices& label_indices, const CellsOfVertex& cells_of,
              std::vector<std::int64_t>& euler)
      : mesh_(mesh), label_indices_(label_indices), cells_of_(cells_of), euler_(euler) {}

  void count(VertexId v) {
    const std::uint32_t *begin = cells_of_.cells.data() + cells_of_.begin[v],
                        *end = cells_of_.cells.data() + cells_of_.begin[v + 1];
    if (begin == end) return;
    edges_.clear();
    bool is_uniform = true;
    for (const std::uint32_t* c = begin; c != end; ++c) {
      const LabelIndex label = label_indices_.of_cell[*c];
      is_uniform = is_uniform && label == label_indices_.of_cell[*begin];
      for (const VertexId w : mesh_.cells[*c])
        if (w >= v) edges_.push_back(std::uint64_t{label} << 32 | w);  // v itself stands for the vertex
    }
    keep_distinct();
    for (const std::uint64_t edge : edges_) add(static_cast<LabelIndex>(edge >> 32), edge, v);
    if (!is_uniform) {
      for (std::uint64_t& edge : edges_) edge &= 0xFFFFFFFF;
      keep_distinct();
    }
    for (const std::uint64_t edge : edges_) add(kAllLabels, edge, v);
  }

 private:
  void keep_distinct() {
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  }
  void add(LabelIndex label, std::uint64_t edge, VertexId v) {
    euler_[label] += static_cast<VertexId>(edge) == v ? 1 : -1;
  }

  const Mesh& mesh_;
  const CellLabelIndices& label_indices_;
  const CellsOfVertex& cells_of_;
  std::vector<std::int64_t>& euler_;
  std::vector<std::uint64_t> edges_;
};

class CellSets {
 public:
  explicit CellSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  CellId root(CellId c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void unite(CellId a, CellId b) {
    const CellId ra = root(a), rb = root(b);
    parent_[std::max(ra, rb)] = std::min(ra, rb);
  }

 private:
  std::vector<CellId> parent_;
};

void count_components(const Adjacency& adjacency, const CellLabelIndices& label_indices,
                      std::vector<MeshTopology>& topology) {
  const std::size_t num_cells = label_indices.of_cell.size();
  CellSets of_label(num_cells), of_all(num_cells);
  const auto unite = [&](CellId a, CellId b) {
    if (label_indices.of_cell[a] == 0 || label_indices.of_cell[b] == 0) return;
    of_all.unite(a, b);
    if (label_indices.of_cell[a] == label_indices.of_cell[b]) of_label.unite(a, b);
  };
  for (std::size_t f = 0; f < 4 * num_cells; ++f)
    if (adjacency.mirror[f] != kNone && adjacency.mirror[f] > f)
      unite(static_cast<CellId>(f / 4), adjacency.mirror[f] / 4);
  for (const auto& group : adjacency.crowded)
    for (const FacetId a : group)
      for (const FacetId b : group) unite(a / 4, b / 4);
  for (CellId c = 0; c < num_cells; ++c) {
    if (label_indices.of_cell[c] == 0) continue;
    if (of_label.root(c) == c) ++topology[label_indices.of_cell[c]].components;
    if (of_all.root(c) == c) ++topology[kAllLabels].components;
  }
}

}  // namespace

std::vector<MeshTopology> find_mesh_topology(const Mesh& mesh, const Adjacency& adjacency,
                                             const CellLabelIndices& label_indices,
                                             const BoundaryFindings& boundary, int threads) {
  std::vector<MeshTopology> topology(label_indices.labels.size());
  for (const LabelIndex label : label_indices.of_cell)
    if (label != 0) {
      ++topology[label].cells;
      ++topology[kAllLabels].cells;
    }
  count_components(adjacency, label_indices, topology);

  std::vector<std::vector<std::int64_t>> parts(static_cast<std::size_t>(threads),
                                               std::vector<std::int64_t>(label_indices.labels.size(), 0));
  const CellsOfVertex cells_of(mesh, label_indices);
  parallel_ranges(mesh.vertices.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    LinkCounter counter(mesh, label_indices, cells_of, parts[thread]);
    for (std::size_t v = begin; v < end; ++v) counter.count(static_cast<VertexId>(v));
  });
  for (std::size_t label = 0; label < topology.size(); ++label) {
    MeshTopology& t = topology[label];
    // Each facet inside is in two cells, each side of the boundary in one: 4 C + sides = 2 F.
    t.euler = static_cast<std::int64_t>((4 * t.cells + boundary.of_label[label].facets) / 2 - t.cells);
    for (const auto& part : parts) t.euler += part[label];
  }
  // A facet in m cells of a label has been counted as m sides, and therefore as m facets.
  for (const auto& group : adjacency.crowded) {
    std::vector<LabelIndex> labels;
    for (const FacetId f : group)
      if (label_indices.of_cell[f / 4] != 0) labels.push_back(label_indices.of_cell[f / 4]);
    if (labels.empty()) continue;
    topology[kAllLabels].euler -= static_cast<std::int64_t>(labels.size()) - 1;
    for (const LabelIndex label : labels) --topology[label].euler;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    for (const LabelIndex label : labels) ++topology[label].euler;
  }
  return topology;
}

}  // namespace podm::verify
