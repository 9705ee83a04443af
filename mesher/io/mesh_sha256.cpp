#include "io/sha256.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"

namespace podm {
namespace {

// Hashes the label values behind `indices` in blocks, without an array of all values.
void update_with_values(Sha256& hash, std::span<const LabelIndex> indices, const std::vector<Label>& labels) {
  std::array<std::uint32_t, 4096> values;
  while (!indices.empty()) {
    const std::size_t count = std::min(indices.size(), values.size());
    for (std::size_t i = 0; i < count; ++i) values[i] = labels[indices[i]].value;
    hash.update(std::span<const std::uint32_t>(values.data(), count));
    indices = indices.subspan(count);
  }
}

// Hashes four bytes per value.
void update_with_label_values(Sha256& hash, const std::vector<Label>& labels) {
  for (const Label& label : labels) hash.update(std::span<const std::uint32_t>(&label.value, 1));
}

}  // namespace

std::string label_image_sha256(const LabelImage& image) {
  Sha256 hash;
  hash.update(std::span<const int>(image.size));
  hash.update(std::span<const double>(image.voxel_to_ras));
  update_with_label_values(hash, image.labels);
  hash.update(std::span(image.voxels));
  return hash.hexadecimal();
}

std::string mesh_sha256(const TetMesh& mesh) {
  Sha256 hash;
  const std::array<std::uint64_t, 3> counts{mesh.vertices.size(), mesh.cells.size(), mesh.facets.size()};
  hash.update(std::span<const std::uint64_t>(counts));
  hash.update(std::span(mesh.vertices));
  hash.update(std::span(mesh.cells));
  update_with_values(hash, mesh.cell_labels, mesh.labels);
  hash.update(std::span(mesh.facets));
  const std::span<const std::array<LabelIndex, 2>> pairs(mesh.facet_labels);
  if (!pairs.empty()) update_with_values(hash, {pairs.front().data(), 2 * pairs.size()}, mesh.labels);
  return hash.hexadecimal();
}

}  // namespace podm
