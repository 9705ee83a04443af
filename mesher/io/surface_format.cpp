#include "io/surface_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "podm/errors.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as little-endian");

using Point3 = std::array<double, 3>;

template <class T>
void put(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_single(const Point3& vector, std::string& bytes) {
  for (const double component : vector) put(static_cast<float>(component), bytes);
}

// Returns the unit normal, or zeros for a facet without area.
Point3 normal_of(const std::array<Point3, 3>& p) {
  Point3 normal;
  for (std::size_t i = 0, j = 1, k = 2; i < 3; ++i, j = (j + 1) % 3, k = (k + 1) % 3)
    normal[i] = (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]);
  const double length = std::hypot(normal[0], normal[1], normal[2]);
  for (double& component : normal) component = length > 0 ? component / length : 0;
  return normal;
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

}  // namespace

std::optional<SurfaceFormat> find_surface_format(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".stl") return SurfaceFormat::kStl;
  if (extension == ".ply") return SurfaceFormat::kPly;
  return std::nullopt;
}

SurfaceFormat surface_format_of(const std::string& path) {
  if (const auto format = find_surface_format(path)) return *format;
  throw InputError(fmt::format("cannot write {}: unknown surface extension '{}', expected .stl or .ply", path,
                               std::filesystem::path(path).extension().string()));
}

std::string surface_path(const std::string& path, const Label& label) {
  const std::filesystem::path whole(path);
  std::string name = fmt::format("{}_{}", whole.stem().string(), label.value);
  if (!label.name.empty()) name += fmt::format("_{}", file_name_part(label.name));
  return (whole.parent_path() / (name + whole.extension().string())).string();
}

// Positions of vertices in a PLY file are of type int.
void check_surface_size(SurfaceFormat format, const std::string& path, const SurfaceSize& size) {
  const std::uint64_t most = format == SurfaceFormat::kStl
                                 ? std::numeric_limits<std::uint32_t>::max()
                                 : static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
  if (std::max(size.vertices, size.facets) <= most) return;
  throw InputError(fmt::format("cannot write {}: {} vertices and {} facets are more than the format numbers",
                               path, size.vertices, size.facets));
}

std::string surface_head(SurfaceFormat format, Space space, const Label& label, const SurfaceSize& size) {
  if (format == SurfaceFormat::kPly)
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment space {}\ncomment label {}\n"
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        to_string(space), label.value, size.vertices, size.facets);
  std::string head = fmt::format("binary STL, space {}, label {}", to_string(space), label.value);
  head.resize(80, ' ');
  put(static_cast<std::uint32_t>(size.facets), head);
  return head;
}

std::size_t bytes_per_vertex(SurfaceFormat format) {
  return format == SurfaceFormat::kPly ? 3 * sizeof(double) : 0;
}

std::size_t bytes_per_facet(SurfaceFormat format) {
  return format == SurfaceFormat::kPly ? 1 + 3 * sizeof(std::uint32_t) : 12 * sizeof(float) + 2;
}

void append_vertex(SurfaceFormat format, const std::array<double, 3>& point, std::string& bytes) {
  if (format == SurfaceFormat::kPly) put(point, bytes);
}

void append_facet(SurfaceFormat format, const std::array<Point3, 3>& points,
                  const std::array<std::uint32_t, 3>& positions, std::string& bytes) {
  if (format == SurfaceFormat::kPly) {
    put(std::uint8_t{3}, bytes);
    put(positions, bytes);
  } else {
    put_single(normal_of(points), bytes);
    for (const Point3& point : points) put_single(point, bytes);
    put(std::uint16_t{0}, bytes);
  }
}

std::vector<std::vector<std::array<std::uint32_t, 3>>> outward_facets(const TetMesh& mesh) {
  std::vector<std::vector<std::array<std::uint32_t, 3>>> facets_of_label(mesh.labels.size());
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto [a, b, c] = mesh.facets[i];
    const auto [first, second] = mesh.facet_labels[i];
    facets_of_label[second].push_back({a, b, c});
    if (first != kBackground) facets_of_label[first].push_back({a, c, b});
  }
  return facets_of_label;
}

}  // namespace podm
