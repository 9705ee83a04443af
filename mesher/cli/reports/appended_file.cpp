#include "cli/reports/appended_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "files/leftovers.h"
#include "files/temporary_file.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kFlags = O_WRONLY | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;

class LockedFile {
 public:
  // Releases the held leftovers during the wait for the lock, so that a signal can end the program.
  LockedFile(const std::string& path, std::optional<HeldLeftovers>& held) {
    descriptor_ = ::open(path.c_str(), kFlags | O_CREAT | O_EXCL, 0666);
    is_new_ = descriptor_ >= 0;
    if (!is_new_) descriptor_ = ::open(path.c_str(), kFlags | O_CREAT, 0666);
    if (descriptor_ < 0) fail_to_write(path, errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    held.reset();
    ::flock(descriptor_, LOCK_EX);
    held.emplace();
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

// Returns 0 or the number of the error.
int write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return 0;
}

int open_stream(const std::string& path) {
  const int descriptor = ::open(path.c_str(), kFlags);
  if (descriptor < 0 && errno == ENXIO)
    throw InputError(fmt::format("cannot write {}: the pipe has no reader", path));
  if (descriptor < 0) fail_to_write(path, errno);
  ::fcntl(descriptor, F_SETFL, O_APPEND);  // writes wait for a slow reader
  return descriptor;
}

}  // namespace

AppendedFile::AppendedFile(const std::string& path) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail_to_write(path, EISDIR);
  const std::string folder = fs::absolute(path).parent_path().string();
  if (::access(fs::exists(status) ? path.c_str() : folder.c_str(), W_OK) != 0) fail_to_write(path, errno);
  if (fs::exists(status) && !fs::is_regular_file(status)) stream_ = open_stream(path);
}

AppendedFile::~AppendedFile() {
  if (stream_ >= 0) ::close(stream_);
}

void AppendedFile::append(const std::string& line) {
  if (stream_ >= 0) {
    if (const int error_number = write_all(stream_, line); error_number != 0)
      fail_to_write(path_, error_number);
    return;
  }
  std::optional<HeldLeftovers> no_signal_ends_this_halfway(std::in_place);
  const LockedFile file(path_, no_signal_ends_this_halfway);
  struct stat before;
  if (::fstat(file.descriptor(), &before) != 0) fail_to_write(path_, errno);
  if (!S_ISREG(before.st_mode)) throw InputError(fmt::format("cannot write {}: not a regular file", path_));
  int error_number = write_all(file.descriptor(), line);
  if (error_number == 0) {
    no_signal_ends_this_halfway.reset();  // the line is complete, and fsync may take long
    if (::fsync(file.descriptor()) == 0 || errno == EINVAL) return;
    error_number = errno;
    no_signal_ends_this_halfway.emplace();
  }
  if (::ftruncate(file.descriptor(), before.st_size) == 0 && before.st_size == 0 && file.is_new())
    ::unlink(path_.c_str());
  fail_to_write(path_, error_number);
}

}  // namespace podm::cli
