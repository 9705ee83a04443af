#include "distributed/image_digest.h"

#include <algorithm>
#include <span>

#include "image/image_by_bricks.h"
#include "io/sha256.h"
#include "runtime/parallel_for.h"

namespace podm {

std::vector<std::string> digests_of_layers(const LabelImage& image, int first, int end, int threads) {
  std::vector<std::string> digests(unsigned_of(end - first));
  parallel_for(digests.size(), num_threads(threads), [&](std::size_t layer, std::size_t) {
    const int low = 4 * (first + static_cast<int>(layer)), high = std::min(low + 4, image.size[2]);
    Sha256 hash;
    hash.update(std::span(image.voxels)
                    .subspan(image.index(0, 0, low), image.index(0, 0, high) - image.index(0, 0, low)));
    digests[layer] = hash.hexadecimal();
  });
  return digests;
}

std::string digest_of_layers(const std::vector<std::string>& digests) {
  Sha256 hash;
  for (const std::string& digest : digests) hash.update(std::span<const char>(digest));
  return hash.hexadecimal();
}

std::string digest_of(const LabelImage& image, int threads) {
  if (const ImageByBricks* in_file = by_bricks(image)) return in_file->digest;
  return digest_of_layers(digests_of_layers(image, 0, BrickGrid(image.size).size()[2], threads));
}

}  // namespace podm
