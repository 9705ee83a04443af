#include <cmath>

#include "image/raw_image.h"
#include "image/size_image.h"

namespace podm::verify {

SizeImage read_size_image(const std::string& path) {
  RawImage raw = read_raw(path);
  if (raw.num_layers != 1)
    refuse(path, "a size image has one value per voxel, this image has " + std::to_string(raw.num_layers));
  SizeImage image;
  image.path = path;
  image.warnings = raw.warnings;
  for (std::size_t axis = 0; axis < 3; ++axis) image.size[axis] = static_cast<int>(raw.size[axis]);
  image.voxel_to_ras = raw.voxel_to_ras;
  orthogonalize_affine(path, image.voxel_to_ras);
  image.radius_mm.resize(raw.bytes.size() / bytes_of(raw.type));
  for_each_voxel(raw, [&](std::size_t i, auto voxel) {
    const double value = raw.slope * static_cast<double>(voxel) + raw.intercept;
    const auto x = static_cast<std::size_t>(image.size[0]), y = static_cast<std::size_t>(image.size[1]);
    if (std::isnan(value))
      refuse(path, "a size image is needed: voxel (" + std::to_string(i % x) + ", " +
                       std::to_string(i / x % y) + ", " + std::to_string(i / x / y) + ") is not a number");
    const auto radius = static_cast<float>(value);
    image.radius_mm[i] = std::isfinite(radius) && radius > 0 ? radius : 0;
  });
  return image;
}

}  // namespace podm::verify
