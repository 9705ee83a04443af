// Chooses the writer by the extension.
#include <fmt/format.h>

#include <filesystem>

#include "files/atomic_file.h"
#include "io/mesh_formats.h"
#include "io/write_vtu.h"
#include "io/write_xdmf.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

// Formats that hold all of a mesh have no losses.
template <void (*Write)(const TetMesh&, const std::string&)>
Losses write_all(const TetMesh& mesh, const std::string& path) {
  Write(mesh, path);
  return {};
}

// Formats that hold all of a mesh but its lines.
template <void (*Write)(const TetMesh&, const std::string&)>
Losses write_without_lines(const TetMesh& mesh, const std::string& path) {
  Write(mesh, path);
  if (mesh.lines.edges.empty()) return {};
  return {fmt::format("the {} edges of lines are left out, the format has none", mesh.lines.edges.size())};
}

// Returns the paths of the files that are written in addition to the file of that path.
using Beside = std::vector<std::string> (*)(const std::string& path);
std::vector<std::string> nothing(const std::string&) { return {}; }
std::vector<std::string> facets(const std::string& path) { return {facets_path_of(path)}; }
std::vector<std::string> arrays(const std::string& path) { return {hdf5_path_of(path)}; }
std::vector<std::string> parts_of_tetgen(const std::string& path) {
  std::vector<std::string> paths;
  for (const char* part : {".node", ".ele", ".face"})
    paths.push_back(std::filesystem::path(path).replace_extension(part).string());
  return paths;
}

struct MeshFormat {
  std::string extension;
  Losses (*write)(const TetMesh&, const std::string&);
  Beside beside;
};

const std::array<MeshFormat, 10> kMeshFormats{{{".vtu", write_vtu, facets},
                                               {".mesh", write_all<write_medit>, nothing},
                                               {".msh", write_all<write_gmsh>, nothing},
                                               {".xdmf", write_all<write_xdmf>, arrays},
                                               {".inp", write_abaqus, nothing},
                                               {".e", write_exodus, nothing},
                                               {".exo", write_exodus, nothing},
                                               {".vtk", write_without_lines<write_legacy_vtk>, facets},
                                               {".node", write_without_lines<write_tetgen>, parts_of_tetgen},
                                               {".ele", write_without_lines<write_tetgen>, parts_of_tetgen}}};

std::string known_extensions() {
  std::string text;
  for (const MeshFormat& format : kMeshFormats)
    text += (&format == &kMeshFormats.front()  ? ""
             : &format == &kMeshFormats.back() ? " or "
                                               : ", ") +
            format.extension;
  return text;
}

const MeshFormat& mesh_format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const MeshFormat& format : kMeshFormats)
    if (extension == format.extension) return format;
  throw InputError(fmt::format("cannot write {}: unknown mesh extension '{}', expected {}", path, extension,
                               known_extensions()));
}

}  // namespace

void check_mesh_path(const std::string& path, const MeshFileOptions& options) {
  const MeshFormat& format = mesh_format_of(path);
  if (options.gmsh_version && format.extension != ".msh")
    throw InputError(fmt::format("cannot write {}: a version of Gmsh's format is for .msh alone", path));
  const AtomicFile trial(path);  // the first step of writing; leaves nothing behind
  for (const std::string& with_it : format.beside(path)) const AtomicFile trial_of_other(with_it);
}

std::vector<std::string> write_mesh(const TetMesh& mesh, const std::string& path,
                                    const MeshFileOptions& options) {
  const MeshFormat& format = mesh_format_of(path);
  if (options.gmsh_version == GmshVersion::k2_2) return write_all<write_gmsh_v2>(mesh, path);
  return format.write(mesh, path);
}

}  // namespace podm
