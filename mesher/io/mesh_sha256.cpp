#include <fmt/format.h>
#include <openssl/evp.h>

#include <bit>
#include <memory>
#include <span>

#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little, "the hash is defined over little-endian bytes");

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw InternalError("SHA-256 is not available");
  }

  template <class T>
  void update(std::span<const T> values) {
    if (EVP_DigestUpdate(context_.get(), values.data(), values.size_bytes()) != 1)
      throw InternalError("SHA-256 failed");
  }

  std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned size = 0;
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1) throw InternalError("SHA-256 failed");
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

// Hashes the label values behind `indices` in blocks, so that no array of values is ever made.
void update_with_values(Sha256& hash, std::span<const LabelIndex> indices, const std::vector<Label>& labels) {
  std::array<std::uint32_t, 4096> values;
  while (!indices.empty()) {
    const std::size_t count = std::min(indices.size(), values.size());
    for (std::size_t i = 0; i < count; ++i) values[i] = labels[indices[i]].value;
    hash.update(std::span<const std::uint32_t>(values.data(), count));
    indices = indices.subspan(count);
  }
}

}  // namespace

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
