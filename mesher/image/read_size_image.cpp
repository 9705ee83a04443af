// Turns a path into a size image: values of any type, scaled as in the header, become radii in mm.
#include <cmath>
#include <cstring>

#include "image/read_formats.h"
#include "podm/image_io.h"

namespace podm {

namespace {

template <class Voxel>
std::vector<float> radii_from(const RawImage& raw) {
  std::vector<float> radii(raw.bytes.size() / sizeof(Voxel));
  for (std::size_t i = 0; i < radii.size(); ++i) {
    Voxel voxel;
    std::memcpy(&voxel, raw.bytes.data() + i * sizeof voxel, sizeof voxel);
    const double value = raw.slope * static_cast<double>(voxel) + raw.intercept;
    if (std::isnan(value))
      refuse_voxel(raw, i, "a size in mm is needed at every voxel, 0 for none", "a number");
    const auto radius = static_cast<float>(value);
    radii[i] = radius > 0 && std::isfinite(radius) ? radius : 0;
  }
  return radii;
}

std::vector<float> radii_from(const RawImage& raw) {
  return with_voxel_type(raw.type, [&](auto voxel) { return radii_from<decltype(voxel)>(raw); });
}

}  // namespace

SizeImage read_size_image(const std::string& path, std::uint64_t most_bytes) {
  RawImage raw = read_raw(path, most_bytes);
  check_room(path, raw.bytes.size() + raw.bytes.size() / bytes_of(raw.type) * sizeof(float), most_bytes);
  checked_spacing(path, raw.voxel_to_ras);
  check_distance(path, raw.size, raw.voxel_to_ras);
  if (raw.num_layers != 1)
    refuse(path, "one value per voxel is needed, this image has " + std::to_string(raw.num_layers));
  SizeImage image{.path = path,
                  .size = {raw.size[0], raw.size[1], raw.size[2]},
                  .voxel_to_ras = raw.voxel_to_ras,
                  .radius_mm = radii_from(raw),
                  .warnings = raw.warnings};
  for (const float radius : image.radius_mm)
    if (radius > 0) return image;
  refuse(path, "no voxel has a size above 0 mm that is finite in single precision: the image bounds nothing");
}

}  // namespace podm
