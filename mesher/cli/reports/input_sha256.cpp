#include "cli/reports/input_sha256.h"

#include <fmt/format.h>

#include <fstream>
#include <vector>

#include "io/sha256.h"
#include "podm/errors.h"

namespace podm::cli {
std::string input_sha256(const ImageArguments& arguments, const LabelImage& image) {
  if (!arguments.is_array && !arguments.is_phantom()) return file_sha256(arguments.path);
  Sha256 digest;
  digest.update(std::span(image.voxels));
  return digest.hexadecimal();
}

std::string file_sha256(const std::string& path) {
  Sha256 digest;
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(1 << 20);
  do {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    digest.update(std::span<const char>(block.data(), static_cast<std::size_t>(file.gcount())));
  } while (file);
  if (!file.eof()) throw InputError(fmt::format("cannot read {}", path));
  return digest.hexadecimal();
}

}  // namespace podm::cli
