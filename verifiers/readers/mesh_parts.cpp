#include "readers/mesh_parts.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace podm::verify {
namespace {

// Names of label arrays in lower case, the most usual first. They come from this project, medit, Gmsh,
// meshio, VTK, VMTK, FEniCS, dolfinx, Abaqus and TetGen converters.
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

// Parses exactly N numbers with one blank between them. Returns none for any other text.
template <std::size_t N>
std::optional<std::array<double, N>> numbers_of(std::string_view text) {
  std::array<double, N> numbers{};
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    if (i > 0 && (at == end || *at++ != ' ')) return std::nullopt;
    const auto [after, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc()) return std::nullopt;
    at = after;
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

std::optional<Space> space_of(std::string_view word) {
  if (word == "RAS") return Space::kRas;
  if (word == "LPS") return Space::kLps;
  if (word == "voxel") return Space::kVoxel;
  return std::nullopt;
}

// "topology 1" or "differs split 3 10 20 30". Returns false for all other words.
bool read_topology_promise(std::string_view words, Mesh& mesh) {
  if (auto number = after_prefix(words, "topology ")) {
    const auto count = take_integer(*number);
    if (!count || *count < 0 || !number->empty()) return false;
    mesh.promised_topology = static_cast<std::uint64_t>(*count);
    return true;
  }
  auto rest = after_prefix(words, "differs ");
  if (!rest) return false;
  ListedDifference listed;
  const std::size_t blank = rest->find(' ');
  if (blank == 0 || blank == std::string_view::npos) return false;
  listed.kind = rest->substr(0, blank);
  rest->remove_prefix(blank + 1);
  const auto label = take_integer(*rest);
  if (!label) return false;
  listed.label = *label;
  for (std::int64_t& at : listed.voxel) {
    const auto index = take_integer(*rest);
    if (!index) return false;
    at = *index;
  }
  if (!rest->empty()) return false;
  mesh.listed_differences.push_back(std::move(listed));
  return true;
}

void read_promise(const MeshFile& file, const std::string& place, std::string_view words, Mesh& mesh) {
  if (const auto claim = after_prefix(words, "unclaimed ")) {
    mesh.unclaimed.emplace(*claim);
    return;
  }
  if (words == "box flat") {
    mesh.promises_flat_box = true;
    return;
  }
  if (const auto angles = after_prefix(words, "dihedral ")) {
    const auto bounds = numbers_of<2>(*angles);
    if (bounds && (*bounds)[0] >= 0 && (*bounds)[0] <= 90 && (*bounds)[1] >= 90 && (*bounds)[1] <= 180) {
      mesh.promised_dihedral_deg = bounds;
      return;
    }
  } else if (const auto delta = after_prefix(words, "lines ")) {
    const auto mm = numbers_of<1>(*delta);
    if (mm && (*mm)[0] > 0 && std::isfinite((*mm)[0])) {
      mesh.promised_lines_delta_mm = (*mm)[0];
      return;
    }
  } else if (const auto width = after_prefix(words, "smoothed ")) {
    const auto mm = numbers_of<1>(*width);
    if (mm && (*mm)[0] > 0 && std::isfinite((*mm)[0])) {
      mesh.smoothing_mm = (*mm)[0];
      return;
    }
  }
  if (read_topology_promise(words, mesh)) return;
  file.refuse(place, fmt::format("the promise '{}' is unknown", words));
}

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

bool read_note(const MeshFile& file, const std::string& place, std::string_view note, Mesh& mesh,
               char blank) {
  if (const auto word = after_prefix(note, std::string("space") + blank)) {
    mesh.space = space_of(*word).value_or(mesh.space);
  } else if (const auto promise = after_prefix(note, std::string("promise") + blank)) {
    read_promise(file, place, *promise, mesh);
  } else {
    return false;
  }
  return true;
}

std::uint8_t side_of_set(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames{"box i-", "box i+", "box j-",
                                                   "box j+", "box k-", "box k+"};
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  return found == kNames.end() ? std::uint8_t{0} : static_cast<std::uint8_t>(found - kNames.begin() + 1);
}

std::uint8_t side_of_pair(std::string_view name) {
  constexpr std::string_view kOutside = "|outside ";
  const std::size_t outside = name.rfind(kOutside);
  return outside == std::string_view::npos ? std::uint8_t{0}
                                           : side_of_set(name.substr(outside + kOutside.size()));
}

void mark_facet_sides(const std::vector<CellSide>& facets,
                      const std::vector<std::pair<CellSide, std::uint8_t>>& sides, Mesh& mesh) {
  if (sides.empty()) return;
  const std::map<CellSide, std::uint8_t> side_of(sides.begin(), sides.end());
  mesh.facet_sides.assign(mesh.facets.size(), 0);
  for (std::size_t i = 0; i < facets.size(); ++i)
    if (const auto side = side_of.find(facets[i]); side != side_of.end()) mesh.facet_sides[i] = side->second;
}

bool is_kept_cell_array(std::string_view name) {
  return name == "label_a" || name == "label_b" || name == kSideArray || label_array_rank(name);
}

void read_comment(const MeshFile& file, std::string_view text, Mesh& mesh, FacetGroups& groups) {
  const auto note = after_prefix(text, " ");
  if (!note || read_note(file, "a comment", *note, mesh)) return;
  if (auto label = after_prefix(*note, "label ")) {
    if (const auto value = take_integer(*label)) mesh.label_names[*value] = *label;
  } else if (auto facets = after_prefix(*note, "pair ")) {
    const auto number = take_integer(*facets);
    if (const auto labels = take_pair(*facets); number && labels)
      groups[*number] = {*labels, side_of_pair(*facets)};
  }
}

void label_facets(const MeshFile& file, const std::string& place, const char* what,
                  const std::vector<std::int64_t>& numbers, const FacetGroups& groups, Mesh& mesh) {
  for (const std::int64_t number : numbers) {
    const auto group = groups.find(number);
    if (group == groups.end()) file.refuse(place, fmt::format("{} {} has no line 'pair'", what, number));
    mesh.facet_labels.push_back(group->second.labels);
    mesh.facet_sides.push_back(group->second.side);
  }
}

std::string upper(std::string_view word) {
  std::string text(word);
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

void read_label_colours(const MeshFile& file, const std::string& place, const NumberArray& numbers,
                        Mesh& mesh) {
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    const auto value = numbers.integer(i);
    std::array<std::uint8_t, 3> colour{};
    bool is_colour = value && i + 3 < numbers.size();
    for (std::size_t c = 0; is_colour && c < colour.size(); ++c) {
      const auto share = numbers.integer(i + 1 + c);
      is_colour = share && *share >= 0 && *share <= 255;
      if (is_colour) colour[c] = static_cast<std::uint8_t>(*share);
    }
    if (!is_colour) file.refuse(place, "not integers in fours: a label value and a colour from 0 to 255");
    mesh.label_colours[*value] = colour;
  }
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

std::optional<std::int64_t> integer_after(std::string_view text, std::string_view prefix) {
  auto rest = after_prefix(text, prefix);
  return rest ? take_integer(*rest) : std::nullopt;
}

std::optional<std::array<LabelValue, 2>> take_pair(std::string_view& text) {
  const auto a = take_integer(text), b = a ? take_integer(text) : std::nullopt;
  return b ? std::optional(std::array<LabelValue, 2>{*a, *b}) : std::nullopt;
}

}  // namespace podm::verify
