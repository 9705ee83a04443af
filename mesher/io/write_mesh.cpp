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

struct MeshFormat {
  std::string extension;
  void (*write)(const TetMesh&, const std::string&);
};

const std::array<MeshFormat, 4> kMeshFormats{
    {{".vtu", write_vtu}, {".mesh", write_medit}, {".msh", write_gmsh}, {".xdmf", write_xdmf}}};

const MeshFormat& mesh_format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const MeshFormat& format : kMeshFormats)
    if (extension == format.extension) return format;
  throw InputError(fmt::format(
      "cannot write {}: unknown mesh extension '{}', expected .vtu, .mesh, .msh or .xdmf", path, extension));
}

}  // namespace

void check_mesh_path(const std::string& path) {
  mesh_format_of(path);
  const AtomicFile trial(path);  // what writing will do first; it leaves nothing behind
}

void write_mesh(const TetMesh& mesh, const std::string& path) { mesh_format_of(path).write(mesh, path); }

}  // namespace podm
