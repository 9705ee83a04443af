// Converts the mesh of a file, as the verifier's readers return it, to a mesh like those of the mesher: cells
// are positively oriented, labels are numbered, and all facets between labels are derived from the cells.
#include "cli/commands/foreign_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "errors.h"
#include "geometry/predicates.h"
#include "io/labelled_facets.h"
#include "io/lines_of_facets.h"
#include "mesh.h"
#include "podm/errors.h"
#include "readers/read_mesh.h"

namespace podm::cli {
namespace {

constexpr std::int64_t kMostValue = std::numeric_limits<std::uint32_t>::max();

verify::Mesh read_file(const std::string& path) try {
  return verify::read_mesh(path);
} catch (const verify::InputError& error) {
  throw InputError(error.what());
}

// Returns the sign of the determinant in doubles if its error cannot change the sign (Shewchuk's bound for
// orient3d).
int side_of_cell(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c, const std::array<double, 3>& d) {
  constexpr double kErrorBound = 7.8e-16;
  double determinant = 0, permanent = 0;
  for (std::size_t x = 0, y = 1, z = 2; x < 3; ++x, y = (y + 1) % 3, z = (z + 1) % 3) {
    const double u = b[x] - a[x], v = (c[y] - a[y]) * (d[z] - a[z]), w = (c[z] - a[z]) * (d[y] - a[y]);
    determinant += u * (v - w);
    permanent += std::abs(u) * (std::abs(v) + std::abs(w));
  }
  if (std::abs(determinant) > kErrorBound * permanent) return determinant > 0 ? 1 : -1;
  const auto point = [](const std::array<double, 3>& p) { return Point{p[0], p[1], p[2]}; };
  return orientation(point(a), point(b), point(c), point(d));
}

class MeshBuilder {
 public:
  MeshBuilder(const std::string& path, verify::Mesh file) : path_(path), file_(std::move(file)) {
    foreign_.format = file_.format;
  }

  ForeignMesh build() {
    check_structure();
    number_labels();
    take_frame_and_promises();
    mesh_.vertices = std::move(file_.vertices);
    mesh_.cells = std::move(file_.cells);
    take_sides();
    orient_cells();
    find_facets();
    if (const auto delta_mm = file_.promised_lines_delta_mm) {
      mesh_.lines = lines_of_facets(mesh_, *delta_mm);
      mesh_.lines.are_claimed = !file_.unclaimed.contains("lines");
      file_.other_cells.erase("lines");
    }
    for (const auto& [kind, count] : file_.other_cells) warn(count, kind + " in the file");
    return std::move(foreign_);
  }

 private:
  [[noreturn]] void refuse(const std::string& fault) const { throw InputError(path_ + ": " + fault); }
  void warn(std::size_t count, const std::string& what) {
    if (count > 0) foreign_.warnings.push_back(fmt::format("{}: {} {}", path_, count, what));
  }

  void check_structure() const {
    if (file_.cells.empty()) refuse("the file has no tetrahedron");
    for (std::size_t i = 0; i < file_.cells.size(); ++i)
      for (const std::uint32_t vertex : file_.cells[i])
        if (vertex >= file_.vertices.size())
          refuse(fmt::format("tetrahedron {} has a vertex that does not exist", i));
    for (std::size_t i = 0; i < file_.vertices.size(); ++i)
      for (const double coordinate : file_.vertices[i])
        if (!std::isfinite(coordinate))
          refuse(fmt::format("vertex {} has a coordinate that is not finite", i));
  }

  // Returns the outside's value in the facets, otherwise the smallest value that no cell has.
  std::uint32_t value_of_outside(const std::set<std::int64_t>& values) const {
    for (const auto& pair : file_.facet_labels)
      for (const std::int64_t value : pair)
        if (!values.contains(value) && value >= 0 && value <= kMostValue)
          return static_cast<std::uint32_t>(value);
    std::uint32_t value = 0;
    while (values.contains(value)) ++value;
    return value;
  }

  void number_labels() {
    const bool has_labels = !file_.cell_labels.empty();
    if (!has_labels) foreign_.warnings.push_back(path_ + ": cells have no labels; all cells get label 1");
    if (!has_labels) file_.cell_labels.assign(file_.cells.size(), 1);
    std::set<std::int64_t> values(file_.cell_labels.begin(), file_.cell_labels.end());
    if (*values.begin() < 0 || *values.rbegin() > kMostValue)
      refuse(fmt::format("label {} is not in [0, 2^32)",
                         *values.begin() < 0 ? *values.begin() : *values.rbegin()));
    if (values.size() >= kMaxLabels)
      refuse(fmt::format("{} labels, at most {} are supported", values.size(), kMaxLabels - 1));
    mesh_.labels.push_back({value_of_outside(values), ""});
    std::map<std::int64_t, LabelIndex> index_of;
    for (const std::int64_t value : values) {
      index_of[value] = static_cast<LabelIndex>(mesh_.labels.size());
      const auto name = file_.label_names.find(value);
      const auto colour = file_.label_colours.find(value);
      Label& label = mesh_.labels.emplace_back(Label{static_cast<std::uint32_t>(value), ""});
      if (name != file_.label_names.end()) label.name = name->second;
      if (colour != file_.label_colours.end()) label.colour = colour->second;
    }
    for (const std::int64_t value : file_.cell_labels) mesh_.cell_labels.push_back(index_of[value]);
  }

  void take_frame_and_promises() {
    const std::map<verify::Space, Space> spaces{{verify::Space::kRas, Space::kRas},
                                                {verify::Space::kLps, Space::kLps},
                                                {verify::Space::kVoxel, Space::kVoxel}};
    const auto space = spaces.find(file_.space);
    if (space != spaces.end()) mesh_.space = space->second;
    if (space == spaces.end())
      foreign_.warnings.push_back(path_ + ": the file names no frame of coordinates; RAS is assumed");
    mesh_.is_optimized = file_.unclaimed.contains("delaunay");
    mesh_.dihedral_bounds_deg = file_.promised_dihedral_deg;
    mesh_.smoothing_mm = file_.smoothing_mm.value_or(0);
    mesh_.is_box_flat = file_.promises_flat_box;
    if (file_.promised_topology) take_listed_differences();
  }

  void take_listed_differences() {
    auto& listed = mesh_.topology_differences.emplace();
    for (const verify::ListedDifference& each : file_.listed_differences) {
      TopologyReport::Difference difference;
      const auto kinds = Names<TopologyDifference>::kAll;
      const auto kind =
          std::find_if(kinds.begin(), kinds.end(), [&](const auto& of) { return of.second == each.kind; });
      if (kind == kinds.end())
        throw InputError(path_ + ": the promise 'differs " + each.kind + "' is unknown");
      difference.kind = kind->first;
      difference.label.value = static_cast<std::uint32_t>(each.label);
      for (std::size_t axis = 0; axis < 3; ++axis)
        difference.voxel[axis] = static_cast<int>(each.voxel[axis]);
      listed.push_back(difference);
    }
  }

  // A vertex is on the sides of the facets around it.
  void take_sides() {
    if (!file_.promises_flat_box) return;
    mesh_.vertex_sides.assign(mesh_.vertices.size(), 0);
    bool is_any = false;
    for (std::size_t f = 0; f < file_.facet_sides.size(); ++f) {
      if (file_.facet_sides[f] == 0) continue;
      is_any = true;
      for (const std::uint32_t vertex : file_.facets[f])
        if (vertex < mesh_.vertices.size())
          mesh_.vertex_sides[vertex] |= static_cast<SideMask>(1u << (file_.facet_sides[f] - 1));
    }
    if (!is_any)
      foreign_.warnings.push_back(
          path_ + ": the file promises a flat box but names no facets of its sides; their sets are left out");
  }

  void orient_cells() {
    std::size_t num_turned = 0, num_flat = 0;
    for (auto& [a, b, c, d] : mesh_.cells) {
      const auto& p = mesh_.vertices;
      const int side = side_of_cell(p[a], p[b], p[c], p[d]);
      if (side < 0) std::swap(c, d);
      num_turned += side < 0;
      num_flat += side == 0;
    }
    warn(num_turned, "cells were negatively oriented and have been reversed");
    warn(num_flat, "cells are flat");
  }

  void find_facets() {
    const auto shared = find_labelled_facets(mesh_);
    if (shared)
      refuse(fmt::format("more than two tetrahedra share the triangle of the vertices {}, {} and {}",
                         (*shared)[0], (*shared)[1], (*shared)[2]));
    warn(count_missing(file_.facets, mesh_.facets),
         "triangles of the file separate no labels and are omitted");
  }

  using Facets = std::vector<std::array<std::uint32_t, 3>>;

  // Returns the number of `facets` that are not in `all`, independent of their orientation.
  static std::size_t count_missing(Facets facets, Facets all) {
    for (Facets* list : {&facets, &all}) {
      for (auto& facet : *list) std::sort(facet.begin(), facet.end());
      std::sort(list->begin(), list->end());
    }
    Facets missing;
    std::set_difference(facets.begin(), facets.end(), all.begin(), all.end(), std::back_inserter(missing));
    return missing.size();
  }

  std::string path_;
  verify::Mesh file_;
  ForeignMesh foreign_;
  TetMesh& mesh_ = foreign_.mesh;
};

}  // namespace

ForeignMesh read_foreign_mesh(const std::string& path) { return MeshBuilder(path, read_file(path)).build(); }

}  // namespace podm::cli
