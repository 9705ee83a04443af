#include "readers/mesh_parts.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>

namespace podm::verify {
namespace {

// Lower case, the most usual first. From: this project, medit, Gmsh, meshio, VTK, VMTK, FEniCS, dolfinx,
// Abaqus and TetGen converters.
constexpr std::array kLabelArrays{"label",         "labels",          "cell_labels",      "medit:ref",
                                  "gmsh:physical", "cellentityids",   "cell_scalars",     "region",
                                  "regions",       "region_id",       "regionid",         "regions_id",
                                  "material",      "materials",       "material_id",      "materialid",
                                  "materialids",   "mat_id",          "subdomain",        "subdomains",
                                  "subdomain_id",  "subdomainid",     "domain",           "domains",
                                  "tissue",        "tissues",         "segmentation",     "attribute",
                                  "attributes",    "cell_tags",       "tetgen:ref",       "tags",
                                  "tag",           "marker",          "markers",          "ref",
                                  "reference",     "elementblockids", "gmsh:geometrical", "scalars"};

}  // namespace

void check_counts(const MeshFile& file, const std::string& place, std::uint64_t num_vertices,
                  std::uint64_t num_cells) {
  if (num_vertices > kMostVertices) file.refuse(place, fmt::format("more than {} vertices", kMostVertices));
  if (num_cells > kMostCells) file.refuse(place, fmt::format("more than {} cells", kMostCells));
}

std::optional<std::size_t> label_array_rank(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto* found = std::find(kLabelArrays.begin(), kLabelArrays.end(), lower);
  if (found == kLabelArrays.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kLabelArrays.begin());
}

std::optional<Space> space_of(std::string_view word) {
  if (word == "RAS") return Space::kRas;
  if (word == "LPS") return Space::kLps;
  if (word == "voxel") return Space::kVoxel;
  return std::nullopt;
}

void read_promise(const MeshFile& file, const std::string& place, std::string_view words, Mesh& mesh) {
  if (const auto claim = after_prefix(words, "unclaimed ")) {
    mesh.unclaimed.emplace(*claim);
    return;
  }
  std::array<double, 2> bounds{};
  auto angles = after_prefix(words, "dihedral ");
  bool is_read = angles.has_value();
  for (double& bound : bounds) {
    if (!is_read) break;
    const char *const begin = angles->data(), *const end = begin + angles->size();
    const auto [after, error] = std::from_chars(begin, end, bound);
    is_read = error == std::errc() && bound >= 0 && bound <= 180;
    angles->remove_prefix(std::min<std::size_t>(angles->size(), static_cast<std::size_t>(after - begin) + 1));
  }
  if (!is_read || bounds[0] > 90 || bounds[1] < 90)
    file.refuse(place, fmt::format("the promise '{}' is none that is known", words));
  mesh.promised_dihedral_deg = bounds;
}

std::optional<std::string_view> after_prefix(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return std::nullopt;
  return text.substr(prefix.size());
}

std::optional<std::int64_t> take_integer(std::string_view& text) {
  std::int64_t value = 0;
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto length = static_cast<std::size_t>(after - text.data());
  if (error != std::errc() || (length < text.size() && text[length] != ' ')) return std::nullopt;
  text.remove_prefix(std::min(length + 1, text.size()));
  return value;
}

}  // namespace podm::verify
