// A digest of an image's labels that ranks can compute together, each of its part.
#pragma once

#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// Returns the SHA-256 of each layer of bricks from `first` on, below `end`. The image must hold its voxels.
std::vector<std::string> digests_of_layers(const LabelImage& image, int first, int end, int threads);
/// Returns the digest of an image from those of all its layers.
std::string digest_of_layers(const std::vector<std::string>& digests);
/// Returns the same digest of an image that holds its voxels, or stays in its file.
std::string digest_of(const LabelImage& image, int threads);

}  // namespace podm
