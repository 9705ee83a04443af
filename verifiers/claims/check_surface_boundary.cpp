#include "claims/check_surface_boundary.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "parallel.h"
#include "ranks/part.h"

namespace podm::verify {

namespace {

constexpr std::size_t kMaxFindings = 100;  // of each kind that is not a violation, per thread

// Around a vertex v, each side with v is an arc from the vertex after v to the vertex before v.
struct Arc {
  LabelIndex set;  // the label whose boundary it is on
  VertexId from, to;
  std::uint32_t side;
};

// One end of an arc.
struct End {
  LabelIndex set;
  VertexId vertex;
  std::uint32_t arc;
  bool is_from;
};

class VertexInspector {
 public:
  VertexInspector(const std::vector<Side>& sides, BoundaryFindings& findings)
      : sides_(sides), findings_(findings) {}

  void inspect(VertexId v, const std::uint32_t* begin, const std::uint32_t* end) {
    if (begin == end) return;
    collect(v, begin, end);
    for (std::size_t first = 0; first < ends_.size();) first = inspect_set(v, first);
  }

 private:
  void collect(VertexId v, const std::uint32_t* begin, const std::uint32_t* end) {
    arcs_.clear();
    ends_.clear();
    labels_.clear();
    for (const std::uint32_t* s = begin; s != end; ++s) {
      const Side& side = sides_[*s];
      const std::size_t i = side.vertices[0] == v ? 0 : side.vertices[1] == v ? 1 : 2;
      const VertexId from = side.vertices[(i + 1) % 3], to = side.vertices[(i + 2) % 3];
      arcs_.push_back({side.label, from, to, *s});
      if (side.across == 0) arcs_.push_back({kAllLabels, from, to, *s});
      labels_.push_back(side.label);
      labels_.push_back(side.across);
    }
    for (std::uint32_t a = 0; a < arcs_.size(); ++a) {
      ends_.push_back({arcs_[a].set, arcs_[a].from, a, true});
      ends_.push_back({arcs_[a].set, arcs_[a].to, a, false});
    }
    std::sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) {
      return a.set != b.set ? a.set < b.set : a.vertex != b.vertex ? a.vertex < b.vertex : a.arc < b.arc;
    });
    fans_.resize(arcs_.size());
    std::iota(fans_.begin(), fans_.end(), 0U);
    num_labels_ = count_distinct(labels_);
  }

  static std::size_t count_distinct(std::vector<LabelIndex>& labels) {
    std::sort(labels.begin(), labels.end());
    return static_cast<std::size_t>(std::unique(labels.begin(), labels.end()) - labels.begin());
  }

  std::uint32_t fan(std::uint32_t arc) {
    while (fans_[arc] != arc) arc = fans_[arc] = fans_[fans_[arc]];
    return arc;
  }

  // Inspects all edges from v in the boundary of one set. Returns the position after them.
  std::size_t inspect_set(VertexId v, std::size_t first) {
    const LabelIndex set = ends_[first].set;
    bool has_only_manifold_edges = true;
    std::size_t last = first;
    while (last < ends_.size() && ends_[last].set == set) {
      std::size_t edge_end = last, outward = 0;
      while (edge_end < ends_.size() && ends_[edge_end].set == set &&
             ends_[edge_end].vertex == ends_[last].vertex)
        outward += ends_[edge_end++].is_from ? 1 : 0;
      const std::size_t count = edge_end - last;
      if (count == 2 && outward == 1)
        fans_[fan(ends_[last].arc)] = fan(ends_[last + 1].arc);
      else
        has_only_manifold_edges = false;
      if (v < ends_[last].vertex) inspect_edge(v, set, last, edge_end, outward);
      last = edge_end;
    }
    if (has_only_manifold_edges) inspect_fans(v, set, first, last);
    return last;
  }

  void inspect_edge(VertexId v, LabelIndex set, std::size_t begin, std::size_t end, std::size_t outward) {
    BoundaryCounts& counts = findings_.of_label[set];
    const bool is_balanced = 2 * outward == end - begin;
    if (is_balanced && end - begin == 2) return;
    const VertexId w = ends_[begin].vertex;
    const bool is_triple = count_labels_at_edge(w) >= 3;
    if (!is_balanced)
      ++counts.unbalanced_edges;
    else
      ++(is_triple ? counts.non_manifold_edges_on_triple_lines : counts.non_manifold_edges);
    Finding finding{is_balanced ? FindingKind::kNonManifoldEdge : FindingKind::kUnbalancedEdge,
                    set,
                    is_triple,
                    {v, w},
                    {}};
    for (std::size_t e = begin; e < end; ++e) finding.cells.push_back(sides_[arcs_[ends_[e].arc].side].cell);
    keep(finding);
  }

  std::size_t count_labels_at_edge(VertexId w) {
    edge_labels_.clear();
    for (const Arc& arc : arcs_) {
      if (arc.from != w && arc.to != w) continue;
      edge_labels_.push_back(sides_[arc.side].label);
      edge_labels_.push_back(sides_[arc.side].across);
    }
    return count_distinct(edge_labels_);
  }

  void inspect_fans(VertexId v, LabelIndex set, std::size_t begin, std::size_t end) {
    std::size_t fans = 0;
    for (std::size_t e = begin; e < end; ++e)
      fans += ends_[e].is_from && fan(ends_[e].arc) == ends_[e].arc ? 1 : 0;
    if (fans <= 1) return;
    const bool is_triple = num_labels_ >= 3;
    BoundaryCounts& counts = findings_.of_label[set];
    ++(is_triple ? counts.non_manifold_vertices_on_triple_lines : counts.non_manifold_vertices);
    Finding finding{FindingKind::kNonManifoldVertex, set, is_triple, {v}, {}};
    for (std::size_t e = begin; e < end; ++e)
      if (ends_[e].is_from) finding.cells.push_back(sides_[arcs_[ends_[e].arc].side].cell);
    keep(finding);
  }

  void keep(Finding& finding) {
    if (finding.kind != FindingKind::kUnbalancedEdge && num_kept_++ >= kMaxFindings) return;
    std::sort(finding.cells.begin(), finding.cells.end());
    finding.cells.erase(std::unique(finding.cells.begin(), finding.cells.end()), finding.cells.end());
    findings_.findings.push_back(std::move(finding));
  }

  const std::vector<Side>& sides_;
  BoundaryFindings& findings_;
  std::vector<Arc> arcs_;
  std::vector<End> ends_;
  std::vector<LabelIndex> labels_, edge_labels_;
  std::vector<std::uint32_t> fans_;
  std::size_t num_labels_ = 0, num_kept_ = 0;
};

}  // namespace

CellLabelIndices::CellLabelIndices(const Mesh& mesh) : labels{0}, of_cell(mesh.cells.size(), 1) {
  if (!has_cell_labels(mesh)) {
    labels.push_back(1);
    return;
  }
  std::unordered_map<LabelValue, LabelIndex> index_of;
  for (const LabelValue label : mesh.cell_labels) index_of.emplace(label, 0);
  std::vector<LabelValue> own;
  for (const auto& [label, index] : index_of) own.push_back(label);
  for (const std::vector<LabelValue>& part : gather(ranks_of(mesh), own))
    for (const LabelValue label : part) index_of.emplace(label, 0);
  index_of.erase(0);
  for (const auto& [label, index] : index_of) labels.push_back(label);
  std::sort(labels.begin() + 1, labels.end());
  for (LabelIndex index = 0; index < labels.size(); ++index) index_of[labels[index]] = index;
  for (std::size_t c = 0; c < of_cell.size(); ++c) of_cell[c] = index_of.find(mesh.cell_labels[c])->second;
}

std::vector<Side> find_sides(const Mesh& mesh, const Adjacency& adjacency,
                             const CellLabelIndices& label_indices, int threads) {
  std::vector<std::vector<Side>> parts(static_cast<std::size_t>(threads));
  parallel_ranges(mesh.cells.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t c = begin; c < end; ++c) {
      const LabelIndex label = label_indices.of_cell[c];
      if (label == 0) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        const FacetId mirror = adjacency.mirror[4 * c + i];
        const LabelIndex across = mirror == kNone ? 0 : label_indices.of_cell[mirror / 4];
        if (across == label) continue;
        const auto& v = mesh.cells[c];
        const auto& f = kFacetVertices[i];  // seen from inside
        const auto at = [&](std::size_t corner) { return v[static_cast<std::size_t>(f[corner])]; };
        parts[thread].push_back({{at(2), at(1), at(0)}, label, across, static_cast<CellId>(c)});
      }
    }
  });
  std::vector<Side> sides = std::move(parts[0]);
  for (std::size_t t = 1; t < parts.size(); ++t) sides.insert(sides.end(), parts[t].begin(), parts[t].end());
  return sides;
}

SidesOfVertex::SidesOfVertex(const std::vector<Side>& sides, std::size_t num_vertices)
    : begin_(num_vertices + 1, 0), sides_(3 * sides.size()) {
  for (const Side& side : sides)
    for (const VertexId v : side.vertices) ++begin_[v];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  for (std::size_t s = sides.size(); s-- > 0;)
    for (const VertexId v : sides[s].vertices) sides_[--begin_[v]] = static_cast<std::uint32_t>(s);
}

void BoundaryCounts::add(const BoundaryCounts& other) {
  facets += other.facets;
  unbalanced_edges += other.unbalanced_edges;
  non_manifold_edges += other.non_manifold_edges;
  non_manifold_edges_on_triple_lines += other.non_manifold_edges_on_triple_lines;
  non_manifold_vertices += other.non_manifold_vertices;
  non_manifold_vertices_on_triple_lines += other.non_manifold_vertices_on_triple_lines;
}

BoundaryFindings inspect_boundary(const Mesh& mesh, const std::vector<Side>& sides,
                                  const SidesOfVertex& sides_of, std::size_t num_labels, int threads) {
  std::vector<BoundaryFindings> parts(static_cast<std::size_t>(threads));
  for (BoundaryFindings& part : parts) part.of_label.resize(num_labels);
  parallel_ranges(mesh.vertices.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    VertexInspector inspector(sides, parts[thread]);
    for (std::size_t v = begin; v < end; ++v) {
      const auto id = static_cast<VertexId>(v);
      if (!owns_vertex(mesh, v)) continue;
      inspector.inspect(id, sides_of.begin(id), sides_of.end(id));
    }
  });
  BoundaryFindings all = std::move(parts[0]);
  for (std::size_t t = 1; t < parts.size(); ++t) {
    for (std::size_t label = 0; label < num_labels; ++label)
      all.of_label[label].add(parts[t].of_label[label]);
    all.findings.insert(all.findings.end(), parts[t].findings.begin(), parts[t].findings.end());
  }
  for (const Side& side : sides) {
    if (!owns_cell(mesh, side.cell)) continue;
    ++all.of_label[side.label].facets;
    if (side.across == 0) ++all.of_label[kAllLabels].facets;
  }
  const std::vector<std::vector<BoundaryCounts>> of_ranks = gather(ranks_of(mesh), all.of_label);
  all.of_label = of_ranks[0];
  for (std::size_t r = 1; r < of_ranks.size(); ++r)
    for (std::size_t label = 0; label < num_labels; ++label) all.of_label[label].add(of_ranks[r][label]);
  return all;
}

}  // namespace podm::verify
