// A file of which any part can be read, by any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace podm {

class PositionedFile {
 public:
  /// Every member throws InputError that names `path` and the fault.
  explicit PositionedFile(const std::string& path);
  ~PositionedFile();
  PositionedFile(const PositionedFile&) = delete;
  PositionedFile& operator=(const PositionedFile&) = delete;

  /// Reads exactly `size` bytes from `offset` on.
  void read(void* to, std::size_t size, std::uint64_t offset) const;
  /// Throws if size or time of the file differ from those at the beginning.
  void expect_unchanged() const;

 private:
  struct State {
    std::int64_t size, seconds, nanoseconds;
    friend bool operator==(const State&, const State&) = default;
  };
  State state() const;

  std::string path_;
  int file_;
  State at_first_{};
};

}  // namespace podm
