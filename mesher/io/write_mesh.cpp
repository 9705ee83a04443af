// Chooses the writer by the extension.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "files/atomic_file.h"
#include "io/mesh_formats.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

// Writers of formats that hold all of a mesh return nothing.
template <void (*Write)(const TetMesh&, const std::string&)>
Losses write_all(const TetMesh& mesh, const std::string& path) {
  Write(mesh, path);
  return {};
}

struct MeshFormat {
  std::string extension;
  Losses (*write)(const TetMesh&, const std::string&);
};

const std::array<MeshFormat, 10> kMeshFormats{{{".vtu", write_all<write_vtu>},
                                               {".mesh", write_all<write_medit>},
                                               {".msh", write_all<write_gmsh>},
                                               {".xdmf", write_all<write_xdmf>},
                                               {".inp", write_abaqus},
                                               {".e", write_exodus},
                                               {".exo", write_exodus},
                                               {".vtk", write_all<write_legacy_vtk>},
                                               {".node", write_all<write_tetgen>},
                                               {".ele", write_all<write_tetgen>}}};

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
  const AtomicFile trial(path);  // what writing will do first; it leaves nothing behind
}

std::vector<std::string> write_mesh(const TetMesh& mesh, const std::string& path,
                                    const MeshFileOptions& options) {
  const MeshFormat& format = mesh_format_of(path);
  if (options.gmsh_version == GmshVersion::k2_2) return write_all<write_gmsh_v2>(mesh, path);
  return format.write(mesh, path);
}

}  // namespace podm
