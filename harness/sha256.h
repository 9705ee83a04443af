#pragma once

#include <string>

namespace podm::bench {

/// 64 hexadecimal digits.
std::string sha256_of(const std::string& text);

/// Throws InputError naming the file when it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace podm::bench
