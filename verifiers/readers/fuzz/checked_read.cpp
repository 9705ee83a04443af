#include "readers/fuzz/checked_read.h"

#include "errors.h"
#include "readers/read_mesh.h"

namespace podm::verify {

using fuzz::check;

void read_checked(const std::string& path, std::size_t num_bytes) {
  constexpr std::size_t kBestRatio = 1032;  // deflate's best ratio
  try {
    const Mesh mesh = read_mesh(path);
    check(mesh.cell_labels.empty() || mesh.cell_labels.size() == mesh.cells.size());
    check(mesh.facet_labels.empty() || mesh.facet_labels.size() == mesh.facets.size());
    check(mesh.cell_labels.empty() || !mesh.cell_label_array.empty());
    check(!mesh.format.empty());
    check(mesh.vertices.size() + mesh.cells.size() + mesh.facets.size() <= num_bytes * kBestRatio);
  } catch (const InputError& error) {
    check(std::string_view(error.what()).starts_with(path.substr(0, path.rfind('.'))));
  }
}

}  // namespace podm::verify
