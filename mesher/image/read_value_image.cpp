// Turns a path into an image of values: voxels of any type, scaled as in the header.
#include <cmath>
#include <cstring>

#include "image/read_formats.h"
#include "podm/image_io.h"

namespace podm {

namespace {

template <class Voxel>
double value_at(const RawImage& raw, std::size_t i) {
  Voxel voxel;
  std::memcpy(&voxel, raw.bytes.data() + i * sizeof voxel, sizeof voxel);
  return raw.slope * static_cast<double>(voxel) + raw.intercept;
}

template <class Voxel, class Value>
std::vector<Value> values_as(const RawImage& raw) {
  std::vector<Value> values(raw.bytes.size() / sizeof(Voxel));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<Value>(value_at<Voxel>(raw, i));
  return values;
}

template <class Voxel>
bool are_exact_in_single_precision(const RawImage& raw) {
  const std::size_t count = raw.bytes.size() / sizeof(Voxel);
  bool are_exact = true;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = value_at<Voxel>(raw, i);
    if (!std::isfinite(value)) refuse_voxel(raw, i, "a value is needed at every voxel", "a finite number");
    are_exact = are_exact && static_cast<double>(static_cast<float>(value)) == value;
  }
  return are_exact;
}

}  // namespace

ValueImage read_value_image(const std::string& path, std::uint64_t most_bytes) {
  const RawImage raw = read_raw(path, most_bytes);
  ValueImage image{
      .path = path, .size = {}, .voxel_to_ras = raw.voxel_to_ras, .values = {}, .warnings = raw.warnings};
  checked_spacing(path, image.voxel_to_ras);
  check_distance(path, raw.size, image.voxel_to_ras);
  if (raw.num_layers != 1)
    refuse(path, "one value per voxel is needed, this image has " + std::to_string(raw.num_layers));
  image.size = {raw.size[0], raw.size[1], raw.size[2]};
  with_voxel_type(raw.type, [&](auto voxel) {
    using Stored = decltype(voxel);
    const bool is_single = are_exact_in_single_precision<Stored>(raw);
    check_room(
        path,
        raw.bytes.size() + raw.bytes.size() / sizeof(Stored) * (is_single ? sizeof(float) : sizeof(double)),
        most_bytes);
    if (is_single) {
      image.values = values_as<Stored, float>(raw);
    } else {
      image.values = values_as<Stored, double>(raw);
    }
  });
  return image;
}

}  // namespace podm
