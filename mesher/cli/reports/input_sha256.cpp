#include "cli/reports/input_sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include "podm/errors.h"

namespace podm::cli {
namespace {

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void update(const void* bytes, std::size_t size) {
    require(EVP_DigestUpdate(context_.get(), bytes, size) == 1);
  }
  std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned size = 0;
    require(EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1);
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
  }

 private:
  static void require(bool succeeded) {
    if (!succeeded) throw InternalError("SHA-256 failed");
  }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string input_sha256(const ImageArguments& arguments, const LabelImage& image) {
  if (!arguments.is_array && !arguments.is_phantom()) return file_sha256(arguments.path);
  Digest digest;
  digest.update(image.voxels.data(), image.voxels.size() * sizeof(LabelIndex));
  return digest.hexadecimal();
}

std::string file_sha256(const std::string& path) {
  Digest digest;
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(1 << 20);
  do {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    digest.update(block.data(), static_cast<std::size_t>(file.gcount()));
  } while (file);
  if (!file.eof()) throw InputError(fmt::format("cannot read {}", path));
  return digest.hexadecimal();
}

}  // namespace podm::cli
