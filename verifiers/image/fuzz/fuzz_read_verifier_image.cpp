// Fuzz target for images: any bytes under the name of any format are an image of labels or of sizes, or they
// are refused with an InputError that names the file.
#include <array>
#include <limits>

#include "errors.h"
#include "fuzz_scratch.h"
#include "image/image.h"
#include "image/size_image.h"

namespace podm::verify {
namespace {

using fuzz::check;

void check_image(const Image& image) {
  std::size_t voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    check(image.size[axis] >= 1 && image.spacing[axis] > 0);
    voxels *= static_cast<std::size_t>(image.size[axis]);
  }
  check(image.voxels.size() == voxels);
}

void check_image(const SizeImage& image) {
  std::size_t voxels = 1;
  for (const int n : image.size) voxels *= static_cast<std::size_t>(n);
  check(image.radius_mm.size() == voxels);
  for (const float radius : image.radius_mm)
    check(radius >= 0 && radius < std::numeric_limits<float>::infinity());
}

template <class Read>
void expect_image_or_refusal(const std::string& path, const Read& read) {
  try {
    check_image(read());
  } catch (const InputError& error) {
    check(std::string_view(error.what()).starts_with(path + ": "));
  }
}

}  // namespace
}  // namespace podm::verify

// The first byte chooses the name, the others are the file. Each name has a folder of its own, as headers
// name files beside them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  constexpr std::array<const char*, 8> kNames{"a.nii", "a.nii.gz", "a.nrrd", "a.mha",
                                              "a.inr", "a.inr.gz", "a.nhdr", "a.mhd"};
  static const std::array<fuzz::ScratchFolder, kNames.size()> folders{};
  if (size == 0) return 0;
  const std::size_t format = data[0] % kNames.size();
  const std::string path = folders[format].write(kNames[format], fuzz::text_of(data + 1, size - 1));
  verify::expect_image_or_refusal(path, [&] { return verify::read_image(path); });
  verify::expect_image_or_refusal(path, [&] { return verify::read_size_image(path); });
  return 0;
}
