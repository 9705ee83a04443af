// SHA-256 of arrays in their memory layout.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <array>
#include <bit>
#include <memory>
#include <span>
#include <string>

#include "podm/errors.h"

namespace podm {

static_assert(std::endian::native == std::endian::little, "hashes are defined over little-endian bytes");

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw InternalError("SHA-256 is not available");
  }

  template <class T>
  void update(std::span<const T> values) {
    if (EVP_DigestUpdate(context_.get(), values.data(), values.size_bytes()) != 1)
      throw InternalError("SHA-256 failed");
  }

  std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned size = 0;
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1) throw InternalError("SHA-256 failed");
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace podm
