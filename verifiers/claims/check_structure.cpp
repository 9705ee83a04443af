// Claim structure.
//   Statements  There are cells. Their vertex ids are in range and their coordinates are finite. Every cell
//               is positively oriented. No two cells have the same vertices. No two vertices of cells have
//               the same coordinates. Every facet belongs to at most two cells, on opposite sides of it. No
//               two cells overlap. No vertex hangs on a facet or edge. Vertices that no cell uses are a
//               warning, wherever they are.
//   Rests on    Exact orientation signs; check_structure_overlap.h proves the overlap test. A mesh whose
//               cells are all negative is reported separately: it is sound but left-handed, and the other
//               statements are judged for its mirror image.
//   Cost        About n log n.
//   Not proved  That the surface is a manifold (claim surface) or the shape right (claims labels, fidelity).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "claims/check_structure_overlap.h"
#include "claims/claims.h"
#include "claims/coincidence.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

Tally check_references(const Mesh& mesh, int threads) {
  Tally tally = tally_over(own_cells(mesh), threads, {}, [&](std::size_t c, Tally& t) {
    ++t.num_checked;
    for (const VertexId v : mesh.cells[c]) {
      if (v < mesh.vertices.size()) continue;
      t.violation({.statement = "vertex ids are in range",
                   .cells = {global_cell(mesh, static_cast<CellId>(c))},
                   .vertices = {v}});
      return;
    }
  });
  tally.add(tally_over({0, mesh.vertices.size()}, threads, {}, [&](std::size_t v, Tally& t) {
    if (!owns_vertex(mesh, v)) return;
    const Point& p = mesh.vertices[v];
    ++t.num_checked;
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) return;
    t.violation(
        {.statement = "coordinates are finite", .vertices = {global_vertex(mesh, static_cast<VertexId>(v))}});
  }));
  if (num_cells(mesh) == 0 && is_first_rank(mesh)) tally.violation({.statement = "the mesh has cells"});
  return tally;
}

// The counts are those of all ranks, `num_exact` that of the rank's own cells.
struct Orientations {
  std::uint64_t positive = 0, negative = 0, flat = 0, num_exact = 0;
  std::vector<std::int8_t> of_cell;
  bool is_left_handed() const { return positive == 0 && flat == 0 && negative > 0; }
  bool is_consistent() const { return flat == 0 && (positive == 0 || negative == 0); }
};

Orientations find_orientations(const Mesh& mesh, int threads) {
  Orientations all;
  all.of_cell.resize(mesh.cells.size());
  const Tally tally = tally_over({0, mesh.cells.size()}, threads, {}, [&](std::size_t c, Tally& t) {
    const CellPoints p = points_of(mesh, static_cast<CellId>(c));
    std::uint64_t num_exact = 0;
    all.of_cell[c] = static_cast<std::int8_t>(orientation(p[0], p[1], p[2], p[3], num_exact));
    if (owns_cell(mesh, static_cast<CellId>(c))) t.num_exact += num_exact;
  });
  all.num_exact = tally.num_exact;
  const IdRange own = own_cells(mesh);
  for (std::size_t c = own.begin; c < own.end; ++c)
    ++(all.of_cell[c] > 0 ? all.positive : all.of_cell[c] < 0 ? all.negative : all.flat);
  for (std::uint64_t* count : {&all.positive, &all.negative, &all.flat})
    *count = sum_over(ranks_of(mesh), *count);
  return all;
}

Tally check_orientations(const Mesh& mesh, const Orientations& orientations, int threads) {
  Tally exact;
  exact.num_exact = orientations.num_exact;
  exact.add(tally_over(own_cells(mesh), threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    ++t.num_checked;
    if (orientations.of_cell[c] > 0) return;
    t.violation(cell_witness(
        mesh, c, orientations.of_cell[c] == 0 ? "no cell is flat" : "cells are positively oriented", 0, 0));
  }));
  return exact;
}

// True at one of the four facets that two equal cells share.
bool is_first_of_duplicates(const Mesh& mesh, FacetId f, FacetId g) {
  const auto& cell = mesh.cells[f / 4];
  return far_vertex(mesh, f) == far_vertex(mesh, g) &&
         far_vertex(mesh, f) == *std::min_element(cell.begin(), cell.end());
}

Witness facet_witness(const Mesh& mesh, const char* statement, FacetId f) {
  const auto v = vertices_of(mesh, f);
  const TrianglePoints p = points_of(mesh, v);
  return {.statement = statement, .vertices = global_vertices(mesh, v), .points = {p.begin(), p.end()}};
}

void report_duplicates(const Mesh& mesh, FacetId f, FacetId g, Tally& t) {
  Witness witness = cell_witness(mesh, f / 4, "no two cells have the same vertices", 0, 0);
  witness.cells.push_back(global_cell(mesh, g / 4));
  t.violation(std::move(witness));
}

// Checks that the two cells at a facet are different and on opposite sides. Cells of equal orientation are on
// opposite sides if they see the facet's vertices turn in opposite senses.
void check_pair(const Mesh& mesh, const Orientations& orientations, FacetId f, FacetId mirror, Tally& t) {
  const auto a = vertices_of(mesh, f), b = vertices_of(mesh, mirror);
  const auto at = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[0]) - b.begin());
  const bool is_same_turn = b[(at + 1) % 3] == a[1];
  const bool is_same_sign = orientations.of_cell[f / 4] == orientations.of_cell[mirror / 4];
  ++t.num_checked;
  if (is_same_turn != is_same_sign) return;
  if (is_first_of_duplicates(mesh, f, mirror)) report_duplicates(mesh, f, mirror, t);
  if (far_vertex(mesh, f) == far_vertex(mesh, mirror)) return;
  Witness witness = facet_witness(mesh, "the two cells of a facet are on opposite sides", f);
  witness.cells = {global_cell(mesh, f / 4), global_cell(mesh, mirror / 4)};
  t.violation(std::move(witness));
}

void check_crowd(const Mesh& mesh, std::vector<FacetId> crowd, Tally& t) {
  Witness witness = facet_witness(mesh, "a facet has at most two cells", crowd[0]);
  witness.value = witness.severity = static_cast<double>(crowd.size());
  for (const FacetId f : crowd) witness.cells.push_back(global_cell(mesh, f / 4));
  ++t.num_checked;
  t.violation(std::move(witness));
  std::sort(crowd.begin(), crowd.end(), [&](FacetId f, FacetId g) {
    return std::pair(far_vertex(mesh, f), f) < std::pair(far_vertex(mesh, g), g);
  });
  for (std::size_t i = 0; i + 1 < crowd.size(); ++i)
    if (is_first_of_duplicates(mesh, crowd[i], crowd[i + 1]))
      report_duplicates(mesh, crowd[i], crowd[i + 1], t);
}

Tally check_facets(const Mesh& mesh, const Adjacency& adjacency, const Orientations& orientations,
                   int threads) {
  Tally tally = tally_over(own_facets(mesh), threads, {}, [&](std::size_t f, Tally& t) {
    const FacetId mirror = adjacency.mirror[f];
    if (mirror == kNone || mirror < f) return;
    check_pair(mesh, orientations, static_cast<FacetId>(f), mirror, t);
  });
  for (const auto& crowd : adjacency.crowded)
    if (owns_cell(mesh, crowd[0] / 4)) check_crowd(mesh, crowd, tally);
  return tally;
}

std::string sentence(const ClaimResult& result, const Mesh& mesh, bool is_left_handed) {
  if (result.num_violations == 0)
    return fmt::format("{} cells, {} vertices, all sound; {} vertices unused", num_cells(mesh),
                       num_vertices(mesh), result.num_warnings);
  if (is_left_handed && result.num_violations == num_cells(mesh))
    return "all cells are negatively oriented: the mesh is sound but left-handed";
  return fmt::format("{} violations, the first: violated: {}", result.num_violations,
                     result.worst[0].statement);
}

}  // namespace

ClaimResult check_structure(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  Tally tally = over_ranks(mesh, check_references(mesh, options.threads));
  const bool can_go_on = tally.num_violations == 0;
  bool is_left_handed = false;
  std::uint64_t num_orphans = 0;
  nlohmann::json details = nlohmann::json::object();
  if (can_go_on) {
    const Orientations orientations = find_orientations(mesh, options.threads);
    is_left_handed = orientations.is_left_handed();
    details = {{"positive_cells", orientations.positive},
               {"negative_cells", orientations.negative},
               {"flat_cells", orientations.flat},
               {"is_left_handed", is_left_handed}};
    const auto add = [&](const char* name, const Tally& own) {
      const Tally part = over_ranks(mesh, own);
      details["violations"][name] = part.num_violations;
      tally.add(part);
    };
    add("orientation", check_orientations(mesh, orientations, options.threads));
    add("facets", check_facets(mesh, adjacency, orientations, options.threads));
    const std::vector<std::uint8_t> is_used = used_vertices(mesh);
    std::vector<VertexId> used;
    for (VertexId v = 0; v < mesh.vertices.size(); ++v) {
      if (!owns_vertex(mesh, v)) continue;
      if (is_used[v])
        used.push_back(v);
      else
        ++num_orphans;
    }
    num_orphans = sum_over(ranks_of(mesh), num_orphans);
    add("coincident_vertices",
        check_coincident_vertices(mesh, used, "no two vertices have the same coordinates"));
    if (orientations.is_consistent()) {
      add("overlap", check_overlap(mesh, adjacency, is_left_handed, options.threads));
      add("hanging_vertices", check_hanging_vertices(mesh, adjacency, options.threads));
    } else {
      details["overlap"] = "not judged: cells are inverted or flat";
    }
  }
  ClaimResult result = result_of("structure", tally);
  result.method = "combinatorial; orientations and separating planes, filtered, then exact";
  result.num_warnings = num_orphans;
  result.details() = std::move(details);
  result.details()["orphan_vertices"] = num_orphans;
  result.reason = sentence(result, mesh, is_left_handed);
  return result;
}

}  // namespace podm::verify
