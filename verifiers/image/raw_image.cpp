#include "image/raw_image.h"

#include <limits>

#include "errors.h"
#include "image/byte_source.h"

namespace podm::verify {

namespace {

// Returns the number of voxels. Throws unless there are three axes (further axes of length 1), none is empty,
// and all voxels are addressable.
std::size_t checked_num_voxels(const std::string& path, const std::vector<std::int64_t>& size) {
  constexpr std::size_t kMostVoxels = std::numeric_limits<std::size_t>::max() / 16;
  std::string sizes;
  for (const std::int64_t n : size) sizes += (sizes.empty() ? "" : " x ") + std::to_string(n);
  if (size.size() < 3) refuse(path, "a 3-D image is needed (" + sizes + " voxels)");
  std::size_t voxels = 1;
  for (std::size_t axis = 0; axis < size.size(); ++axis) {
    if (size[axis] < 1) refuse(path, "the image has no voxels (" + sizes + ")");
    if (axis >= 3 && size[axis] > 1) refuse(path, "a 3-D image is needed (" + sizes + " voxels)");
    const auto n = static_cast<std::size_t>(size[axis]);
    if (n > std::numeric_limits<int>::max() || n > kMostVoxels / voxels)
      refuse(path, "the image is too large (" + sizes + " voxels)");
    voxels *= n;
  }
  return voxels;
}

}  // namespace

void refuse(const std::string& path, const std::string& fault) { throw InputError(path + ": " + fault); }

void read_voxels(const std::string& path, RawImage& raw, ByteSource& source) {
  const std::size_t num_voxels = checked_num_voxels(path, raw.size), bytes = bytes_of(raw.type);
  if (raw.num_layers > std::numeric_limits<std::size_t>::max() / bytes / num_voxels)
    refuse(path, std::to_string(raw.num_layers) + " layers are too many");
  const std::size_t needed = num_voxels * raw.num_layers * bytes;
  source.expect_room_for(needed);
  raw.bytes.resize(needed);
  source.read(raw.bytes.data(), needed);
  source.expect_end();
}

}  // namespace podm::verify
