#include "cli/append_line.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "files/leftovers.h"
#include "files/temporary_file.h"

namespace podm::cli {
namespace {

class LockedFile {
 public:
  explicit LockedFile(const std::string& path) {
    constexpr int kFlags = O_WRONLY | O_APPEND | O_CLOEXEC;
    descriptor_ = ::open(path.c_str(), kFlags | O_CREAT | O_EXCL, 0666);
    is_new_ = descriptor_ >= 0;
    if (!is_new_) descriptor_ = ::open(path.c_str(), kFlags | O_CREAT, 0666);
    if (descriptor_ < 0) fail_to_write(path, errno);
    ::flock(descriptor_, LOCK_EX);
  }
  ~LockedFile() { ::close(descriptor_); }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;
  int descriptor() const { return descriptor_; }
  bool is_new() const { return is_new_; }

 private:
  int descriptor_;
  bool is_new_;
};

// 0 or the number of the error.
int write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
}

}  // namespace

void check_appendable(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) fail_to_write(path, EISDIR);
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  const bool exists = std::filesystem::exists(path, error);
  if (::access(exists ? path.c_str() : folder.c_str(), W_OK) != 0) fail_to_write(path, errno);
}

void append_line(const std::string& path, const std::string& line) {
  const HeldLeftovers no_signal_ends_this_halfway;
  const LockedFile file(path);
  struct stat before;
  if (::fstat(file.descriptor(), &before) != 0) fail_to_write(path, errno);
  const int error_number = write_all(file.descriptor(), line);
  if (error_number == 0) return;
  if (::ftruncate(file.descriptor(), before.st_size) == 0 && before.st_size == 0 && file.is_new())
    ::unlink(path.c_str());
  fail_to_write(path, error_number);
}

}  // namespace podm::cli
