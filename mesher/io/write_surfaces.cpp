// One closed surface per label: the facets with the label on one side, oriented outwards.
#include "files/atomic_file.h"
#include "io/surface_format.h"
#include "io/vertex_subset.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

using Facets = std::vector<std::array<std::uint32_t, 3>>;

void write_surface(SurfaceFormat format, const TetMesh& mesh, const Facets& facets, const Label& label,
                   const std::string& path, VertexSubset& subset, AtomicFile& file) {
  subset.assign(facets);
  const SurfaceSize size{subset.vertices().size(), facets.size()};
  check_surface_size(format, path, size);
  file.write(surface_head(format, mesh.space, label, size));
  std::string bytes;
  const auto flush = [&] {
    file.write(bytes);
    bytes.clear();
  };
  for (const std::uint32_t vertex : subset.vertices()) {
    append_vertex(format, mesh.vertices[vertex], bytes);
    flush();
  }
  for (const auto& [a, b, c] : facets) {
    append_facet(format, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                 {subset.position(a), subset.position(b), subset.position(c)}, bytes);
    flush();
  }
}

}  // namespace

void check_surface_path(const std::string& path) {
  surface_format_of(path);
  const AtomicFile trial(path);  // tests the folder; the surfaces have other names in it
}

bool is_surface_path(const std::string& path) { return find_surface_format(path).has_value(); }

void write_surfaces(const TetMesh& mesh, const std::string& path) {
  const SurfaceFormat format = surface_format_of(path);
  const std::vector<Facets> facets_of_label = outward_facets(mesh);
  VertexSubset subset(mesh.vertices.size());
  std::deque<AtomicFile> files;
  for (std::size_t label = 1; label < mesh.labels.size(); ++label) {
    if (facets_of_label[label].empty()) continue;
    const std::string its_path = surface_path(path, mesh.labels[label]);
    files.emplace_back(its_path);
    write_surface(format, mesh, facets_of_label[label], mesh.labels[label], its_path, subset, files.back());
    files.back().finish();
  }
  publish_together(files);
}

}  // namespace podm
