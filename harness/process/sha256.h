#pragma once

#include <map>
#include <string>

namespace podm::bench {

/// Returns 64 hexadecimal digits.
std::string sha256_of(const std::string& text);

/// Throws InputError that names the file when it cannot be read.
std::string sha256_of_file(const std::string& path);

/// Hashes of files; each file is read once.
class FileHashes {
 public:
  /// Returns "absent" where there is no file. Throws InputError when it cannot be read.
  const std::string& of(const std::string& path);

 private:
  std::map<std::string, std::string> hashes_;
};

}  // namespace podm::bench
