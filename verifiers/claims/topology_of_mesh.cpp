#include "claims/topology_of_mesh.h"

#include <algorithm>

namespace podm::verify {

namespace {

class MeshFinder {
 public:
  MeshFinder(const Mesh& mesh, const Adjacency& adjacency) : mesh_(mesh), adjacency_(adjacency) {}

  TopologyOfMesh operator()() {
    number_regions();
    list_cells_of_vertices();
    for (VertexId v = 0; v < mesh_.vertices.size(); ++v) look_at(v);
    count_facets();
    count_cavities();
    return std::move(found_);
  }

 private:
  // Cells of the background, and everything beyond the mesh.
  std::uint32_t outside() const { return static_cast<std::uint32_t>(found_.regions.size()); }
  std::uint32_t piece(CellId c) const {
    return found_.region_of[c] == kNone ? outside() : found_.region_of[c];
  }
  std::uint32_t piece_across(FacetId f) const {
    const FacetId mirror = adjacency_.mirror[f];
    return mirror == kNone ? outside() : piece(mirror / 4);
  }
  void number_regions() {
    NumberSets sets(mesh_.cells.size());
    for (FacetId f = 0; f < adjacency_.mirror.size(); ++f) {
      const FacetId mirror = adjacency_.mirror[f];
      if (mirror == kNone || mirror < f) continue;
      if (mesh_.cell_labels[f / 4] == mesh_.cell_labels[mirror / 4]) sets.unite(f / 4, mirror / 4);
    }
    found_.region_of.assign(mesh_.cells.size(), kNone);
    std::vector<std::uint32_t> region_of_root(mesh_.cells.size(), kNone);
    for (CellId c = 0; c < mesh_.cells.size(); ++c) {
      if (mesh_.cell_labels[c] == 0) continue;
      std::uint32_t& region = region_of_root[sets.root(c)];
      if (region == kNone) {
        region = static_cast<std::uint32_t>(found_.regions.size());
        found_.regions.push_back({.label = mesh_.cell_labels[c]});
        found_.first.push_back(c);
      }
      found_.region_of[c] = region;
      ++found_.regions[region].size;
    }
  }

  void list_cells_of_vertices() {
    begin_.assign(mesh_.vertices.size() + 1, 0);
    for (const auto& cell : mesh_.cells)
      for (const VertexId v : cell) ++begin_[v];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    cells_of_.resize(begin_.back());
    for (CellId c = 0; c < mesh_.cells.size(); ++c)
      for (const VertexId v : mesh_.cells[c]) cells_of_[--begin_[v]] = c;
  }

  // The vertex itself, and its edges to vertices of greater number. Each is in a region if all pieces around
  // it are that region.
  void look_at(VertexId v) {
    around_.clear();
    std::vector<std::uint32_t> pieces;
    for (std::size_t i = begin_[v]; i < begin_[v + 1]; ++i) {
      const CellId c = cells_of_[i];
      pieces.push_back(piece(c));
      for (unsigned k = 0; k < 4; ++k) {
        const VertexId w = mesh_.cells[c][k];
        if (w > v) around_.push_back({w, piece(c)});
        const bool is_outer = mesh_.cells[c][k] != v && adjacency_.mirror[4 * c + k] == kNone;
        if (!is_outer) continue;
        pieces.push_back(outside());
        for (unsigned j = 0; j < 4; ++j)
          if (j != k && mesh_.cells[c][j] > v) around_.push_back({mesh_.cells[c][j], outside()});
      }
    }
    keep_distinct(pieces);
    if (pieces.size() == 1 && pieces[0] != outside()) --found_.regions[pieces[0]].euler;
    keep_distinct(around_);
    for (std::size_t i = 0, end = 0; i < around_.size(); i = end) {
      end = i + 1;
      while (end < around_.size() && around_[end].first == around_[i].first) ++end;
      if (end == i + 1 && around_[i].second != outside()) ++found_.regions[around_[i].second].euler;
    }
  }

  void count_facets() {
    for (CellId c = 0; c < mesh_.cells.size(); ++c) {
      if (found_.region_of[c] == kNone) continue;
      ++found_.regions[found_.region_of[c]].euler;
      for (FacetId f = 4 * c; f < 4 * c + 4; ++f) {
        if (piece_across(f) != found_.region_of[c]) {
          for (const VertexId v : vertices_of(mesh_, f)) at_boundary_.push_back({found_.region_of[c], v});
        } else if (adjacency_.mirror[f] > f) {
          --found_.regions[found_.region_of[c]].euler;
        }
      }
    }
  }

  // Unites the vertices of each boundary facet of a region.
  void count_cavities() {
    const std::vector<RegionVertex> in_order = at_boundary_;
    keep_distinct(at_boundary_);
    const auto number = [&](const RegionVertex& of) {
      return static_cast<std::uint32_t>(std::lower_bound(at_boundary_.begin(), at_boundary_.end(), of) -
                                        at_boundary_.begin());
    };
    NumberSets sets(at_boundary_.size());
    for (std::size_t i = 0; i < in_order.size(); i += 3) {
      sets.unite(number(in_order[i]), number(in_order[i + 1]));
      sets.unite(number(in_order[i]), number(in_order[i + 2]));
    }
    for (LabelRegion& region : found_.regions) region.cavities = -1;
    for (std::uint32_t i = 0; i < at_boundary_.size(); ++i)
      if (sets.root(i) == i) ++found_.regions[at_boundary_[i].first].cavities;
  }

  template <class Item>
  static void keep_distinct(std::vector<Item>& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
  }

  using RegionVertex = std::pair<std::uint32_t, VertexId>;

  const Mesh& mesh_;
  const Adjacency& adjacency_;
  std::vector<std::uint32_t> begin_;  // by vertex: of its cells in cells_of_
  std::vector<CellId> cells_of_;
  std::vector<std::pair<VertexId, std::uint32_t>> around_;  // the other end of an edge, and a piece around it
  std::vector<RegionVertex> at_boundary_;                   // three for each boundary facet, then each once
  TopologyOfMesh found_;
};

}  // namespace

TopologyOfMesh find_topology_of_mesh(const Mesh& mesh, const Adjacency& adjacency) {
  return MeshFinder(mesh, adjacency)();
}

}  // namespace podm::verify
