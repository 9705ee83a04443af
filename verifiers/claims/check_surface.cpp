// Claim surface.
//   Statements  First, the boundary of a label's cells, and of all cells together, is a closed and oriented
//               surface. Its facets, turned outwards from their cells, pass each edge as often in one
//               direction as in the other. Second, if the file lists facets with the labels on their two
//               sides, these are the facets between different labels, each once, with the labels of the cells
//               there and all turned alike. A label's boundary is the facets between one of its cells and a
//               cell of another label, or none. Cells of label 0 count as outside. A mesh without labels
//               counts as one label.
//   Rests on    Vertex ids alone. The check is combinatorial and uses no coordinates; there is no rounding.
//   Cost        Linear in the cells, about 40 bytes per cell.
//   Not proved  That the surface does not pass through itself (structure's "no overlap" proves it). Nor that
//               it is a manifold of the right topology, since no mesher of multi-label images promises it.
//               The claim reports non-manifold edges (passed four times or more) and vertices (more than one
//               fan of facets), separately where three or more labels meet (the background counted). It
//               reports components (of cells, across facets) and the Euler number (of the label's closed cell
//               complex) beside the image's for 6-connected labels (26 for the rest) and for 26-connected
//               ones (6 for the rest). Listed facets without labels are compared too, and differences are
//               warnings.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "claims/check_surface_boundary.h"
#include "claims/check_surface_listed.h"
#include "claims/check_surface_topology.h"
#include "claims/claims.h"
#include "claims/tally.h"
#include "image/image_topology.h"
#include "parallel.h"

namespace podm::verify {

namespace {

nlohmann::json to_json(const BoundaryCounts& counts, const MeshTopology& topology) {
  return {{"cells", topology.cells},
          {"components", topology.components},
          {"euler", topology.euler},
          {"boundary_facets", counts.facets},
          {"unbalanced_edges", counts.unbalanced_edges},
          {"non_manifold_edges", counts.non_manifold_edges},
          {"non_manifold_edges_on_triple_lines", counts.non_manifold_edges_on_triple_lines},
          {"non_manifold_vertices", counts.non_manifold_vertices},
          {"non_manifold_vertices_on_triple_lines", counts.non_manifold_vertices_on_triple_lines}};
}

nlohmann::json to_json(const Topology& topology) {
  return {{"voxels", topology.voxels},
          {"components_6", topology.components_6},
          {"components_26", topology.components_26},
          {"euler_6", topology.euler_6},
          {"euler_26", topology.euler_26}};
}

const char* statement(FindingKind kind) {
  switch (kind) {
    case FindingKind::kUnbalancedEdge:
      return "each boundary edge is passed as often in one direction as in the other";
    case FindingKind::kNonManifoldEdge:
      return "non-manifold edge (reported, not judged)";
    case FindingKind::kNonManifoldVertex:
      break;
  }
  return "non-manifold vertex (reported, not judged)";
}

class Report {
 public:
  Report(const Mesh& mesh, const CellLabelIndices& label_indices)
      : mesh_(mesh), label_indices_(label_indices) {}

  void add(const Finding& finding) {
    const bool is_violation = finding.kind == FindingKind::kUnbalancedEdge;
    Witness witness;
    witness.statement = statement(finding.kind);
    for (const CellId c : finding.cells) witness.cells.push_back(global_cell(mesh_, c));
    witness.vertices = global_vertices(mesh_, finding.vertices);
    if (is_violation)
      places_.bad_cells.insert(places_.bad_cells.end(), witness.cells.begin(), witness.cells.end());
    for (const VertexId v : finding.vertices) witness.points.push_back(mesh_.vertices[v]);
    witness.value = static_cast<double>(finding.cells.size());
    witness.severity = is_violation ? 3 : finding.is_on_triple_line ? 0 : 1;
    witness.label = label_indices_.labels[finding.label];
    places_.witnesses.add(witness);
  }

  void add(const char* listed_statement, const std::vector<std::uint32_t>& facets) {
    for (const std::uint32_t f : facets) {
      Witness witness;
      witness.statement = listed_statement;
      for (const VertexId v : mesh_.facets[f]) {
        witness.vertices.push_back(global_vertex(mesh_, v));
        if (v < mesh_.vertices.size()) witness.points.push_back(mesh_.vertices[v]);
      }
      witness.value = static_cast<double>(global_facet(mesh_, f));
      witness.severity = 2;
      places_.witnesses.add(witness);
    }
  }

  // Collective.
  void finish(ClaimResult& result) const {
    const Places all = over_ranks(mesh_, places_);
    result.worst = all.witnesses.worst_first();
    result.bad_cells = all.bad_cells;
  }

 private:
  struct Places {
    WorstWitnesses witnesses;
    std::vector<GlobalId> bad_cells;

    void add(const Places& other) { witnesses.add(other.witnesses); }
    template <class Stream>
    void transfer(Stream& stream) {
      stream(witnesses);
    }
  };

  const Mesh& mesh_;
  const CellLabelIndices& label_indices_;
  Places places_;
};

// Judges statement 2. A list without labels may be of any facets: differences are then warnings.
std::uint64_t judge_listed(const Mesh& mesh, const ListedFacets& listed, Report& report,
                           ClaimResult& result) {
  if (num_facets(mesh) == 0) return 0;
  const std::vector<std::uint64_t> counts =
      sum_over(ranks_of(mesh), std::vector<std::uint64_t>{listed.missing, listed.stray.size(),
                                                          listed.mislabelled.size(), listed.turned.size()});
  result.details()["listed_facets"] = {{"listed", num_facets(mesh)},
                                       {"missing", counts[0]},
                                       {"stray", counts[1]},
                                       {"mislabelled", counts[2]},
                                       {"turned", counts[3]}};
  const std::uint64_t faults = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (!has_facet_labels(mesh)) {
    result.num_warnings += faults;
    return 0;
  }
  report.add("each listed facet lies between two labels and is listed once", listed.stray);
  report.add("each listed facet has the labels of its cells", listed.mislabelled);
  report.add("the listed facets are turned alike", listed.turned);
  return faults;
}

nlohmann::json labels_table(const Mesh& mesh, const CellLabelIndices& label_indices,
                            const BoundaryFindings& boundary, const std::vector<MeshTopology>& topology,
                            const ImageTopology* image) {
  auto table = nlohmann::json::array();
  for (LabelIndex index = 1; index < label_indices.labels.size(); ++index) {
    auto row = to_json(boundary.of_label[index], topology[index]);
    const LabelValue label = label_indices.labels[index];
    row["label"] = label;
    if (const auto name = mesh.label_names.find(label); name != mesh.label_names.end())
      row["name"] = name->second;
    if (image != nullptr && label >= 0 && label <= std::numeric_limits<std::uint32_t>::max()) {
      const auto found = image->of_label.find(static_cast<std::uint32_t>(label));
      row["image"] = to_json(found == image->of_label.end() ? Topology{} : found->second);
    }
    table.push_back(row);
  }
  return table;
}

}  // namespace

ClaimResult check_surface(const Mesh& mesh, const Adjacency& adjacency, const Image* image,
                          const Options& options) {
  ClaimResult result;
  result.claim = "surface";
  result.method = "combinatorial, on vertex ids";
  const CellLabelIndices label_indices(mesh);
  const int threads = num_threads(options.threads);
  const std::vector<Side> sides = find_sides(mesh, adjacency, label_indices, threads);
  const auto is_own = [&](const Side& side) { return owns_cell(mesh, side.cell); };
  const std::uint64_t num_sides =
      sum_over(ranks_of(mesh), static_cast<std::uint64_t>(std::count_if(sides.begin(), sides.end(), is_own)));
  if (num_sides == 0) {
    result.reason = "the mesh has no cells of a label";
    return result;
  }
  const SidesOfVertex sides_of(sides, mesh.vertices.size());
  const BoundaryFindings boundary =
      inspect_boundary(mesh, sides, sides_of, label_indices.labels.size(), threads);
  const std::vector<MeshTopology> topology =
      find_mesh_topology(mesh, adjacency, label_indices, boundary, threads);

  Report report(mesh, label_indices);
  for (const Finding& finding : boundary.findings) report.add(finding);
  BoundaryCounts sum;
  for (const BoundaryCounts& counts : boundary.of_label) sum.add(counts);
  const std::uint64_t listed_faults =
      judge_listed(mesh, inspect_listed_facets(mesh, label_indices, sides, sides_of), report, result);
  result.num_checked = num_sides;
  result.num_violations = sum.unbalanced_edges + listed_faults;
  result.num_warnings += sum.non_manifold_edges + sum.non_manifold_edges_on_triple_lines +
                         sum.non_manifold_vertices + sum.non_manifold_vertices_on_triple_lines;
  report.finish(result);

  std::optional<ImageTopology> image_topology;
  if (image != nullptr) image_topology = find_topology(*image, threads);
  result.details()["labels"] =
      labels_table(mesh, label_indices, boundary, topology, image_topology ? &*image_topology : nullptr);
  result.details()["all"] = to_json(boundary.of_label[kAllLabels], topology[kAllLabels]);
  if (image_topology) result.details()["all"]["image"] = to_json(image_topology->all);
  result.details()["connectivity"] =
      "mesh: cells across facets; image: 6 for the label with 26 for the rest, and 26 with 6";
  result.reason = fmt::format(
      "{} boundary edges of {} labels not closed and oriented, {} listed facets wrong; non-manifold edges {} "
      "+ "
      "{} on triple lines, vertices {} + {}",
      sum.unbalanced_edges, label_indices.labels.size() - 1, listed_faults, sum.non_manifold_edges,
      sum.non_manifold_edges_on_triple_lines, sum.non_manifold_vertices,
      sum.non_manifold_vertices_on_triple_lines);
  result.verdict = verdict_on(result.num_violations);
  return result;
}

}  // namespace podm::verify
