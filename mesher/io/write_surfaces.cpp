// One closed surface per label, as binary STL or PLY: the facets with the label on one side, oriented
// outwards.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <filesystem>

#include "files/atomic_file.h"
#include "io/vertex_subset.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as little-endian");

using Facet = std::array<std::uint32_t, 3>;

// STL has only single precision, and no shared vertices.
void write_stl(const TetMesh& mesh, const std::vector<Facet>& facets, const Label& label, VertexSubset&,
               AtomicFile& file) {
  std::string head = fmt::format("binary STL, space {}, label {}", to_string(mesh.space), label.value);
  head.resize(80, ' ');
  file.write(head);
  file.put(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    std::array<std::array<double, 3>, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = mesh.vertices[facet[i]];
    std::array<double, 3> normal;
    for (int i = 0, j = 1, k = 2; i < 3; ++i, j = (j + 1) % 3, k = (k + 1) % 3)
      normal[i] = (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]);
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    for (const double component : normal) file.put(static_cast<float>(length > 0 ? component / length : 0));
    for (const auto& point : p)
      for (const double coordinate : point) file.put(static_cast<float>(coordinate));
    file.put(std::uint16_t{0});
  }
}

void write_ply(const TetMesh& mesh, const std::vector<Facet>& facets, const Label& label,
               VertexSubset& subset, AtomicFile& file) {
  subset.assign(facets);
  file.write(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment space {}\ncomment label {}\n"
                  "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  to_string(mesh.space), label.value, subset.vertices().size(), facets.size()));
  for (const std::uint32_t vertex : subset.vertices()) file.put(mesh.vertices[vertex]);
  for (const Facet& facet : facets) {
    file.put(std::uint8_t{3});
    for (const std::uint32_t vertex : facet) file.put(subset.position(vertex));
  }
}

struct SurfaceFormat {
  std::string extension;
  void (*write)(const TetMesh&, const std::vector<Facet>&, const Label&, VertexSubset&, AtomicFile&);
};

const std::array<SurfaceFormat, 2> kSurfaceFormats{{{".stl", write_stl}, {".ply", write_ply}}};

// Returns null for another extension.
const SurfaceFormat* find_surface_format(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const SurfaceFormat& format : kSurfaceFormats)
    if (extension == format.extension) return &format;
  return nullptr;
}

const SurfaceFormat& surface_format_of(const std::string& path) {
  if (const SurfaceFormat* format = find_surface_format(path)) return *format;
  throw InputError(fmt::format("cannot write {}: unknown surface extension '{}', expected .stl or .ply", path,
                               std::filesystem::path(path).extension().string()));
}

// Replaces every character except letters, digits, dots and dashes, because it may have a meaning for a file
// system or a shell.
std::string file_name_part(std::string name) {
  constexpr std::size_t kLongest = 80;  // file systems limit the whole name to 255 bytes
  for (char& c : name) {
    const bool plain =
        (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-';
    if (!plain) c = '_';
  }
  return name.substr(0, kLongest);
}

std::string surface_path(const std::string& path, const Label& label) {
  const std::filesystem::path whole(path);
  std::string name = fmt::format("{}_{}", whole.stem().string(), label.value);
  if (!label.name.empty()) name += fmt::format("_{}", file_name_part(label.name));
  return (whole.parent_path() / (name + whole.extension().string())).string();
}

// Returns the facets of each label, oriented so that their normals point out of the label.
std::vector<std::vector<Facet>> outward_facets(const TetMesh& mesh) {
  std::vector<std::vector<Facet>> facets_of_label(mesh.labels.size());
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto [a, b, c] = mesh.facets[i];
    const auto [first, second] = mesh.facet_labels[i];
    facets_of_label[second].push_back({a, b, c});
    if (first != kBackground) facets_of_label[first].push_back({a, c, b});
  }
  return facets_of_label;
}

}  // namespace

void check_surface_path(const std::string& path) {
  surface_format_of(path);
  const AtomicFile trial(path);  // tests the folder; the surfaces have other names in it
}

bool is_surface_path(const std::string& path) { return find_surface_format(path) != nullptr; }

void write_surfaces(const TetMesh& mesh, const std::string& path) {
  const SurfaceFormat& format = surface_format_of(path);
  const std::vector<std::vector<Facet>> facets_of_label = outward_facets(mesh);
  VertexSubset subset(mesh.vertices.size());
  std::deque<AtomicFile> files;
  for (std::size_t label = 1; label < mesh.labels.size(); ++label) {
    if (facets_of_label[label].empty()) continue;
    files.emplace_back(surface_path(path, mesh.labels[label]));
    format.write(mesh, facets_of_label[label], mesh.labels[label], subset, files.back());
    files.back().finish();
  }
  publish_together(files);
}

}  // namespace podm
