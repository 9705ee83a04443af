#include "claims/check_surface_topology.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "parallel.h"
#include "ranks/part.h"

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

// Sets of cells, named by their first cells.
class CellSets {
 public:
  explicit CellSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  CellId root(CellId c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  // Returns false if the cells are in one set already.
  bool unite(CellId a, CellId b) {
    const CellId ra = root(a), rb = root(b);
    parent_[std::max(ra, rb)] = std::min(ra, rb);
    return ra != rb;
  }

 private:
  std::vector<CellId> parent_;
};

// The components of the cells of all ranks: each rank unites its own cells. What joins sets of two ranks is
// sent to the owner of the greater cell, which names both sets; all ranks then unite these names.
class Components {
 public:
  explicit Components(const Mesh& mesh) : mesh_(mesh), sets_(mesh.cells.size()) {}

  // `a` is the rank's own.
  void unite(CellId a, CellId b) {
    if (owns_cell(mesh_, b))
      sets_.unite(a, b);
    else
      across_.emplace_back(a, b);
  }

  // Collective. Returns the number of components by the index of their cells, of `num_indices`.
  template <class IndexOf>
  std::vector<std::uint64_t> count(std::size_t num_indices, const IndexOf& index_of) {
    std::vector<std::uint64_t> counts(num_indices, 0);
    const IdRange own = own_cells(mesh_);
    for (auto c = static_cast<CellId>(own.begin); c < own.end; ++c)
      if (sets_.root(c) == c) ++counts[index_of(c)];
    counts = sum_over(ranks_of(mesh_), counts);
    for (const Joint& joint : united(joints(index_of))) --counts[joint.index];
    return counts;
  }

 private:
  struct Joint {
    GlobalId a, b;
    LabelIndex index;
    auto operator<=>(const Joint&) const = default;
  };

  // Collective. Returns the pairs of sets of all ranks that cells join, each once on a rank.
  template <class IndexOf>
  std::vector<Joint> joints(const IndexOf& index_of) {
    auto lists = lists_for<Joint>(ranks_of(mesh_));
    for (const auto& [a, b] : across_) {
      const GlobalId other = global_cell(mesh_, b);
      lists[owner_of_cell(mesh_, other)].push_back({global_cell(mesh_, sets_.root(a)), other, index_of(a)});
    }
    std::vector<Joint> found = exchange_joined(ranks_of(mesh_), std::move(lists));
    const IdRange own = own_cells(mesh_);
    const GlobalId first = own.size() == 0 ? 0 : global_cell(mesh_, static_cast<CellId>(own.begin));
    for (Joint& joint : found)
      joint.b = global_cell(mesh_, sets_.root(static_cast<CellId>(joint.b - first + own.begin)));
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  // Collective. Returns those of the ranks' pairs that join two sets which the pairs before do not join.
  std::vector<Joint> united(const std::vector<Joint>& own) const {
    std::map<GlobalId, CellId> position;
    std::vector<Joint> all;
    for (const std::vector<Joint>& part : gather(ranks_of(mesh_), own))
      for (const Joint& joint : part) {
        all.push_back(joint);
        for (const GlobalId set : {joint.a, joint.b})
          position.try_emplace(set, static_cast<CellId>(position.size()));
      }
    CellSets sets(position.size());
    std::erase_if(
        all, [&](const Joint& joint) { return !sets.unite(position.at(joint.a), position.at(joint.b)); });
    return all;
  }

  const Mesh& mesh_;
  CellSets sets_;
  std::vector<std::pair<CellId, CellId>> across_;  // the rank's own cell, and another rank's
};

void count_components(const Mesh& mesh, const Adjacency& adjacency, const CellLabelIndices& label_indices,
                      std::vector<MeshTopology>& topology) {
  Components of_label(mesh), of_all(mesh);
  const auto unite = [&](CellId a, CellId b) {
    if (label_indices.of_cell[a] == 0 || label_indices.of_cell[b] == 0) return;
    of_all.unite(a, b);
    if (label_indices.of_cell[a] == label_indices.of_cell[b]) of_label.unite(a, b);
  };
  const IdRange own = own_facets(mesh);
  for (auto f = static_cast<FacetId>(own.begin); f < own.end; ++f)
    if (adjacency.mirror[f] != kNone && adjacency.mirror[f] > f) unite(f / 4, adjacency.mirror[f] / 4);
  for (const auto& group : adjacency.crowded)
    for (const FacetId a : group)
      for (const FacetId b : group)
        if (owns_cell(mesh, a / 4) && a < b) unite(a / 4, b / 4);
  const auto counts = of_label.count(topology.size(), [&](CellId c) { return label_indices.of_cell[c]; });
  for (std::size_t label = 1; label < topology.size(); ++label) topology[label].components = counts[label];
  // Index 1 is that of all labels here, and 0 that of the background.
  topology[kAllLabels].components =
      of_all.count(2, [&](CellId c) { return label_indices.of_cell[c] == 0 ? 0U : 1U; })[1];
}

void count_cells(const Mesh& mesh, const CellLabelIndices& label_indices,
                 std::vector<MeshTopology>& topology) {
  std::vector<std::uint64_t> counts(topology.size(), 0);
  const IdRange own = own_cells(mesh);
  for (std::size_t c = own.begin; c < own.end; ++c) ++counts[label_indices.of_cell[c]];
  counts = sum_over(ranks_of(mesh), counts);
  for (std::size_t label = 1; label < counts.size(); ++label) {
    topology[label].cells = counts[label];
    topology[kAllLabels].cells += counts[label];
  }
}

}  // namespace

std::vector<MeshTopology> find_mesh_topology(const Mesh& mesh, const Adjacency& adjacency,
                                             const CellLabelIndices& label_indices,
                                             const BoundaryFindings& boundary, int threads) {
  std::vector<MeshTopology> topology(label_indices.labels.size());
  count_cells(mesh, label_indices, topology);
  count_components(mesh, adjacency, label_indices, topology);

  std::vector<std::vector<std::int64_t>> parts(static_cast<std::size_t>(threads),
                                               std::vector<std::int64_t>(label_indices.labels.size(), 0));
  const CellsOfVertex cells_of(mesh, label_indices);
  parallel_ranges(mesh.vertices.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    LinkCounter counter(mesh, label_indices, cells_of, parts[thread]);
    for (std::size_t v = begin; v < end; ++v)
      if (owns_vertex(mesh, v)) counter.count(static_cast<VertexId>(v));
  });
  std::vector<std::int64_t> euler(topology.size(), 0);
  for (std::size_t label = 0; label < topology.size(); ++label)
    for (const auto& part : parts) euler[label] += part[label];
  // A facet in m cells of a label has been counted as m sides, and therefore as m facets.
  for (const auto& group : adjacency.crowded) {
    if (!owns_cell(mesh, group[0] / 4)) continue;
    std::vector<LabelIndex> labels;
    for (const FacetId f : group)
      if (label_indices.of_cell[f / 4] != 0) labels.push_back(label_indices.of_cell[f / 4]);
    if (labels.empty()) continue;
    euler[kAllLabels] -= static_cast<std::int64_t>(labels.size()) - 1;
    for (const LabelIndex label : labels) --euler[label];
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    for (const LabelIndex label : labels) ++euler[label];
  }
  euler = sum_over(ranks_of(mesh), euler);
  for (std::size_t label = 0; label < topology.size(); ++label) {
    MeshTopology& t = topology[label];
    // Each facet inside is in two cells, each side of the boundary in one: 4 C + sides = 2 F.
    t.euler = euler[label] +
              static_cast<std::int64_t>((4 * t.cells + boundary.of_label[label].facets) / 2 - t.cells);
  }
  return topology;
}

}  // namespace podm::verify
