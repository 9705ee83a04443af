// Any bytes under any format's name either are an image or are refused with an InputError that names the
// file.
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "podm/errors.h"
#include "podm/image_io.h"

namespace {

// Held until the process ends; the file in it is written anew for each input.
std::string temporary_folder() {
  std::string name = "/tmp/fuzz_read_image-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) std::abort();
  return name;
}

void check(const podm::LabelImage& image) {
  if (image.voxels.size() != image.num_voxels() || image.labels.size() < 2) std::abort();
  for (const podm::LabelIndex voxel : image.voxels)
    if (voxel >= image.labels.size()) std::abort();
  for (const double spacing : image.spacing)
    if (!(spacing > 0)) std::abort();
}

}  // namespace

// The first byte chooses the name, the others are the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string folder = temporary_folder();
  constexpr std::array<const char*, 8> kNames{"/a.nii", "/a.nii.gz", "/a.nrrd", "/a.mha",
                                              "/a.inr", "/a.inr.gz", "/a.nhdr", "/a.mhd"};
  if (size == 0) return 0;
  const std::string path = folder + kNames[data[0] % kNames.size()];
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  try {
    check(podm::read_image(path));
  } catch (const podm::InputError& error) {
    if (!std::string(error.what()).starts_with(path + ": ")) std::abort();
  }
  return 0;
}
