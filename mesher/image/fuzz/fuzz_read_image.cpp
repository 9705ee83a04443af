// Any bytes under the name of any format either are an image, of labels or of sizes, or are refused with an
// InputError that names the file.
#include <array>
#include <cmath>
#include <limits>

#include "fuzz_scratch.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {
namespace {

using fuzz::check;

void check_image(const LabelImage& image) {
  check(image.voxels.size() == image.num_voxels() && image.labels.size() >= 2);
  for (const LabelIndex voxel : image.voxels) check(voxel < image.labels.size());
  for (const double spacing : image.spacing) check(spacing > 0);
}

void check_image(const SizeImage& image) {
  std::size_t voxels = 1;
  for (const int n : image.size) voxels *= static_cast<std::size_t>(n);
  check(image.radius_mm.size() == voxels);
  for (const float radius : image.radius_mm)
    check(radius >= 0 && radius < std::numeric_limits<float>::infinity());
}

void check_image(const ValueImage& image) {
  std::size_t voxels = 1;
  for (const int n : image.size) voxels *= static_cast<std::size_t>(n);
  const auto check_values = [voxels](const auto& values) {
    check(values.size() == voxels);
    for (const auto value : values) check(std::isfinite(value));
  };
  std::visit(check_values, image.values);
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
}  // namespace podm

// The first byte chooses the name, the other bytes are the file. The file is alone in its folder, as headers
// can name files beside them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  constexpr std::array<const char*, 8> kNames{"a.nii", "a.nii.gz", "a.nrrd", "a.mha",
                                              "a.inr", "a.inr.gz", "a.nhdr", "a.mhd"};
  static const std::array<fuzz::ScratchFolder, kNames.size()> folders{};
  if (size == 0) return 0;
  const std::size_t format = data[0] % kNames.size();
  const std::string path = folders[format].write(kNames[format], fuzz::text_of(data + 1, size - 1));
  expect_image_or_refusal(path, [&] { return read_image(path, {}, 1); });
  expect_image_or_refusal(path, [&] { return read_size_image(path); });
  expect_image_or_refusal(path, [&] { return read_value_image(path); });
  return 0;
}
