#include "run_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "claims/claims.h"
#include "errors.h"
#include "image/smoothing.h"
#include "ranks/part.h"

namespace podm::verify {

namespace {

bool is_given(Needs needs, const Options& options, const Mesh& mesh) {
  switch (needs) {
    case Needs::kNothing:
      return true;
    case Needs::kImage:
      return !options.image_path.empty();
    case Needs::kFlatBox:
      return !options.image_path.empty() && options.is_box_flat.value_or(mesh.promises_flat_box) &&
             mesh.part == nullptr;
    case Needs::kLines:
      return !options.image_path.empty() && (options.lines_delta_mm || mesh.promised_lines_delta_mm) &&
             mesh.part == nullptr;
    case Needs::kBound:
      return options.radius_mm || !options.radius_of.empty() || !options.size_image_path.empty() ||
             !options.interface_sizes.empty();
    case Needs::kDihedralBound:
      return options.min_dihedral_deg || options.max_dihedral_deg || mesh.promised_dihedral_deg;
    case Needs::kPromisedImage:
      return !options.image_path.empty() && mesh.promised_topology && mesh.part == nullptr;
  }
  return false;
}

bool needs_image(Needs needs) {
  return needs == Needs::kImage || needs == Needs::kPromisedImage || needs == Needs::kLines ||
         needs == Needs::kFlatBox;
}

// True if all vertex ids and coordinates are sound, which every claim except structure relies on.
// Collective.
bool has_sound_references(const Mesh& mesh) {
  const auto is_finite = [](const Point& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  };
  const auto is_in_range = [&](const std::array<VertexId, 4>& cell) {
    return std::all_of(cell.begin(), cell.end(), [&](VertexId v) { return v < mesh.vertices.size(); });
  };
  const bool is_sound = std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_finite) &&
                        std::all_of(mesh.cells.begin(), mesh.cells.end(), is_in_range);
  return num_cells(mesh) > 0 && sum_over(ranks_of(mesh), is_sound ? 0 : 1) == 0;
}

ClaimResult not_run(const std::string& claim, const std::string& reason) {
  ClaimResult result;
  result.claim = claim;
  result.reason = reason;
  return result;
}

template <class T>
const T* pointer(const std::optional<T>& value) {
  return value ? &*value : nullptr;
}

// Returns Levenshtein's distance: the least number of insertions, deletions and replacements that turn a into
// b.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

std::string nearest_claim(const std::string& name) {
  return std::min_element(all_claims().begin(), all_claims().end(),
                          [&](const Claim& a, const Claim& b) {
                            return edit_distance(name, a.name) < edit_distance(name, b.name);
                          })
      ->name;
}

}  // namespace

const std::vector<Claim>& all_claims() {
  using I = const Inputs&;
  using A = const Adjacency&;
  using O = const Options&;
  static const std::vector<Claim> kAll{
      {"structure", Needs::kNothing, [](I i, A a, O o) { return check_structure(i.mesh, a, o); }},
      {"radius_edge", Needs::kNothing, [](I i, A a, O o) { return check_radius_edge(i.mesh, a, o); }},
      {"boundary_angles", Needs::kNothing, [](I i, A a, O o) { return check_boundary_angles(i.mesh, a, o); }},
      {"size", Needs::kBound,
       [](I i, A, O o) { return check_size(i.mesh, pointer(i.image), pointer(i.sizes), o); }},
      {"dihedral", Needs::kDihedralBound, [](I i, A, O o) { return check_dihedral(i.mesh, o); }},
      {"delaunay", Needs::kNothing, [](I i, A a, O o) { return check_delaunay(i.mesh, a, o); }},
      {"conformity", Needs::kNothing,
       [](I i, A a, O o) { return check_conformity(i.mesh, a, pointer(i.schedule), o); }},
      {"surface", Needs::kNothing,
       [](I i, A a, O o) { return check_surface(i.mesh, a, pointer(i.image), o); }},
      {"labels", Needs::kImage, [](I i, A, O o) { return check_labels(i.mesh, *i.image, o); }},
      {"surface_vertices", Needs::kImage,
       [](I i, A a, O o) { return check_surface_vertices(i.mesh, a, *i.image, o); }},
      {"box", Needs::kFlatBox, [](I i, A a, O o) { return check_box(i.mesh, a, *i.image, o); }},
      {"lines", Needs::kLines, [](I i, A a, O o) { return check_lines(i.mesh, a, *i.image, o); }},
      {"fidelity", Needs::kImage, [](I i, A a, O o) { return check_fidelity(i.mesh, a, *i.image, o); }},
      {"topology", Needs::kPromisedImage, [](I i, A a, O) { return check_topology(i.mesh, a, *i.image); }}};
  return kAll;
}

void check_claims(const Options& options) {
  for (const std::string& name : options.claims) {
    const auto is_named = [&](const Claim& claim) { return claim.name == name; };
    if (std::any_of(all_claims().begin(), all_claims().end(), is_named)) continue;
    std::string known;
    for (const Claim& claim : all_claims()) known += std::string(known.empty() ? "" : ", ") + claim.name;
    throw InputError(fmt::format("--claims: no claim '{}', nearest is '{}'; known claims: {}", name,
                                 nearest_claim(name), known));
  }
}

std::vector<std::string> chosen_claims(const Options& options, const Mesh& mesh) {
  std::vector<std::string> chosen;
  for (const Claim& claim : all_claims()) {
    const bool is_chosen =
        options.claims.empty()
            ? is_given(claim.needs, options, mesh) && !mesh.unclaimed.contains(claim.name)
            : std::find(options.claims.begin(), options.claims.end(), claim.name) != options.claims.end();
    if (is_chosen) chosen.push_back(claim.name);
  }
  return chosen;
}

Inputs read_inputs(const Options& options, Mesh mesh) {
  Inputs inputs{std::move(mesh), std::nullopt, std::nullopt, std::nullopt};
  if (options.space) inputs.mesh.space = *options.space;
  if (!options.image_path.empty()) inputs.image = read_image(options.image_path, options.selection);
  if (!options.size_image_path.empty()) inputs.sizes = read_size_image(options.size_image_path);
  if (inputs.image && options.selection != LabelSelection{}) select_labels(*inputs.image, options.selection);
  if (inputs.image) inputs.image->is_box_flat = options.is_box_flat.value_or(inputs.mesh.promises_flat_box);
  const std::optional<double> width = options.smooth_mm ? options.smooth_mm : inputs.mesh.smoothing_mm;
  if (inputs.image && width) inputs.image->smoothing = smooth(*inputs.image, *width, options.threads);
  if (options.selection.background != 0) move_background(inputs.mesh, options.selection.background);
  if (!options.schedule_path.empty()) inputs.schedule = read_schedule(options.schedule_path);
  return inputs;
}

std::vector<ClaimResult> run_claims(const Inputs& inputs, const Options& options,
                                    const std::vector<std::string>& names,
                                    const std::function<void(const std::string&)>& announce) {
  const bool is_sound = has_sound_references(inputs.mesh);
  const Adjacency adjacency = is_sound ? find_adjacency(inputs.mesh, options.threads) : Adjacency{};
  std::vector<ClaimResult> results;
  for (const std::string& name : names) {
    announce(name);
    const auto start = std::chrono::steady_clock::now();
    const auto claim = std::find_if(all_claims().begin(), all_claims().end(),
                                    [&](const Claim& known) { return known.name == name; });
    if (!is_sound && name != "structure") {
      results.push_back(not_run(name, "the mesh is empty or has invalid vertex ids or coordinates"));
    } else if (needs_image(claim->needs) && !inputs.image) {
      results.push_back(not_run(name, "no image given (--image)"));
    } else {
      results.push_back(claim->check(inputs, adjacency, options));
    }
    results.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return results;
}

}  // namespace podm::verify
