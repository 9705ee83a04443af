#include "readers/read_mesh.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "errors.h"
#include "readers/formats.h"
#include "readers/mesh_file.h"

namespace podm::verify {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kGzip = ".gz";

// The parts of a mesh file's path: "x" ".vtu" ".gz".
struct MeshPath {
  std::string stem, extension, gzip;

  explicit MeshPath(std::string path) {
    if (path.ends_with(kGzip)) {
      gzip = kGzip;
      path.resize(path.size() - kGzip.size());
    }
    extension = fs::path(path).extension().string();
    stem = path.substr(0, path.size() - extension.size());
    for (char& c : extension)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }

  // Returns the file with this stem and another ending, none if it does not exist. If it exists both plain
  // and gzipped, the one that is gzipped like this file is returned.
  std::optional<std::string> beside(const std::string& ending) const {
    const std::string plain = stem + ending, gzipped = plain + std::string(kGzip);
    for (const std::string& path : gzip.empty() ? std::array{plain, gzipped} : std::array{gzipped, plain}) {
      std::error_code ignored;
      if (fs::exists(path, ignored)) return path;
    }
    return std::nullopt;
  }
};

// Reads the facets beside the mesh only if the mesh itself lists no triangles.
Mesh read_with_facets(const MeshPath& path, const MeshFile& file, Mesh (*read)(const MeshFile&),
                      void (*read_facets)(const MeshFile&, Mesh&)) {
  Mesh mesh = read(file);
  mesh.path = file.path();
  if (const auto facets = path.beside("_facets" + path.extension); facets && mesh.facets.empty())
    read_facets(MeshFile(*facets), mesh);
  return mesh;
}

Mesh read_tetgen_files(const MeshPath& path, const MeshFile& file) {
  const bool is_nodes = path.extension == ".node";
  const std::string missing = is_nodes ? ".ele" : ".node";
  const auto other_path = path.beside(missing);
  if (!other_path)
    throw InputError(fmt::format("{}{}: no such file beside {}", path.stem, missing, file.path()));
  const MeshFile other(*other_path);
  std::optional<MeshFile> faces;
  if (const auto face_path = path.beside(".face")) faces.emplace(*face_path);
  return read_tetgen(is_nodes ? file : other, is_nodes ? other : file, faces ? &*faces : nullptr);
}

bool is_exodus(const std::string& extension) {
  return extension == ".e" || extension == ".exo" || extension == ".ex2" || extension == ".g";
}

Mesh read_format(const MeshPath& path, const MeshFile& file) {
  if (path.extension == ".vtu") return read_with_facets(path, file, read_vtu, read_vtu_facets);
  if (path.extension == ".pvtu") return read_with_facets(path, file, read_pvtu, read_pvtu_facets);
  if (path.extension == ".vtk") return read_with_facets(path, file, read_legacy_vtk, read_legacy_vtk_facets);
  if (path.extension == ".inp") return read_abaqus(file);
  if (is_exodus(path.extension)) return read_exodus(file);
  if (path.extension == ".mesh") return read_medit(file);
  if (path.extension == ".meshb") return read_medit_binary(file);
  if (path.extension == ".msh") return read_gmsh(file);
  return read_tetgen_files(path, file);
}

void check_extension(const std::string& path, const std::string& extension) {
  for (const char* known : {".vtu", ".pvtu", ".vtk", ".mesh", ".meshb", ".msh", ".inp", ".node", ".ele"})
    if (extension == known) return;
  if (is_exodus(extension)) return;
  throw InputError(
      fmt::format("{}: no mesh format is called '{}'; known: .vtu, .pvtu, .vtk, .mesh, .meshb, .msh, .inp, "
                  ".e, .exo, .ex2, .g, .node, .ele, and each with .gz",
                  path, extension));
}

}  // namespace

Mesh read_mesh(const std::string& path) {
  const MeshPath parts(path);
  check_extension(path, parts.extension);
  const auto refuse_size = [&]() -> Mesh {
    throw InputError(path + ": needs more memory than the machine has");
  };
  try {
    const MeshFile file(path);
    Mesh mesh = read_format(parts, file);
    mesh.path = path;
    if (file.is_gzipped()) mesh.format += ", gzip";
    return mesh;
  } catch (const std::bad_alloc&) {
    return refuse_size();
  } catch (const std::length_error&) {
    return refuse_size();
  }
}

}  // namespace podm::verify
