// The bytes of one mesh file, and errors about them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "readers/byte_buffer.h"

namespace podm::verify {

class MeshFile {
 public:
  /// Maps the file. A ".gz" is inflated into memory instead, step by step, so memory grows with the data and
  /// not with the announced size. Throws InputError if the file is missing, not regular, empty or damaged.
  explicit MeshFile(const std::string& path);
  ~MeshFile();
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;

  const std::string& path() const { return path_; }
  bool is_gzipped() const { return is_gzipped_; }
  /// All bytes, inflated; places in messages are positions in them.
  std::string_view bytes() const { return bytes_; }

  /// Throws InputError "path: place: fault".
  [[noreturn]] void refuse(const std::string& place, const std::string& fault) const;
  std::string line_at(std::size_t position) const;   ///< "line 12"
  static std::string byte_at(std::size_t position);  ///< "byte 345"

 private:
  void map();
  void inflate();

  std::string path_;
  bool is_gzipped_;
  std::string_view bytes_;
  void* mapping_ = nullptr;
  ByteBuffer inflated_;
};

}  // namespace podm::verify
