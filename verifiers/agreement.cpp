#include "agreement.h"

#include "sha256.h"

namespace podm::verify {
namespace {

std::string hash_of(const Image& image) {
  Sha256 hash;
  hash.add(image.size);
  hash.add(image.voxel_to_ras);
  hash.add(image.voxels);
  hash.add(std::vector<std::uint32_t>(image.covered_labels.begin(), image.covered_labels.end()));
  if (image.smoothing) hash.add(image.smoothing->voxel_weights);
  return hash.hex();
}

std::string hash_of(const SizeImage& image) {
  Sha256 hash;
  hash.add(image.size);
  hash.add(image.voxel_to_ras);
  hash.add(image.radius_mm);
  return hash.hex();
}

}  // namespace

void expect_same_index(const Options& options, Communication& ranks) {
  if (ranks.size() == 1) return;
  std::string hash;
  do_on_all(ranks, [&] { hash = sha256_of(options.mesh_path); });
  expect_agreement(ranks, {{options.mesh_path, "SHA-256 " + hash}});
}

void expect_same_inputs(const Inputs& inputs, const Options& options, Communication& ranks) {
  if (ranks.size() == 1) return;
  std::vector<Fact> facts;
  do_on_all(ranks, [&] {
    const auto add = [&](const std::string& path, const std::string& hash) {
      facts.push_back({path, "SHA-256 of its content " + hash});
    };
    if (inputs.image) add(options.image_path, hash_of(*inputs.image));
    if (inputs.sizes) add(options.size_image_path, hash_of(*inputs.sizes));
    if (inputs.schedule) add(options.schedule_path, sha256_of(options.schedule_path));
  });
  expect_agreement(ranks, facts);
}

}  // namespace podm::verify
