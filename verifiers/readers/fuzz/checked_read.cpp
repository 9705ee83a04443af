#include "readers/fuzz/checked_read.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "errors.h"
#include "readers/read_mesh.h"

namespace podm::verify {
namespace {

const std::string& folder() {
  static const std::string path = [] {
    std::string pattern = "/tmp/fuzz_read_mesh-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    return pattern + "/";
  }();
  return path;
}

void check(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

void write_fuzz_file(const char* name, std::string_view bytes) {
  std::ofstream(folder() + name, std::ios::binary) << bytes;
}

void read_fuzz_file(const char* name, std::size_t num_bytes) {
  constexpr std::size_t kBestRatio = 1032;  // of deflate
  try {
    const Mesh mesh = read_mesh(folder() + name);
    check(mesh.cell_labels.empty() || mesh.cell_labels.size() == mesh.cells.size());
    check(mesh.facet_labels.empty() || mesh.facet_labels.size() == mesh.facets.size());
    check(mesh.cell_labels.empty() || !mesh.cell_label_array.empty());
    check(!mesh.format.empty());
    check(mesh.vertices.size() + mesh.cells.size() + mesh.facets.size() <= num_bytes * kBestRatio);
  } catch (const InputError& error) {
    check(std::string(error.what()).starts_with(folder()));
  }
}

}  // namespace podm::verify
