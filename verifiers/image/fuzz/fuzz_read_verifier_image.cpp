// Any bytes under any format's name either are an image or are refused with an InputError that names the
// file.
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "errors.h"
#include "image/image.h"

namespace {

// Held until the process ends; the file in it is written anew for each input.
std::string temporary_folder() {
  std::string name = "/tmp/fuzz_read_verifier_image-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) std::abort();
  return name;
}

void check(const podm::verify::Image& image) {
  std::size_t voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (image.size[axis] < 1 || !(image.spacing[axis] > 0)) std::abort();
    voxels *= static_cast<std::size_t>(image.size[axis]);
  }
  if (image.voxels.size() != voxels) std::abort();
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
    check(podm::verify::read_image(path));
  } catch (const podm::verify::InputError& error) {
    if (!std::string(error.what()).starts_with(path + ": ")) std::abort();
  }
  return 0;
}
