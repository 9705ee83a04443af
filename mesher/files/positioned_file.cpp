#include "files/positioned_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "podm/errors.h"

namespace podm {

PositionedFile::PositionedFile(const std::string& path)
    : path_(path), file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0) throw InputError(path_ + ": cannot be opened (" + std::strerror(errno) + ")");
  try {
    at_first_ = state();
  } catch (...) {
    close(file_);
    throw;
  }
}

PositionedFile::~PositionedFile() { close(file_); }

void PositionedFile::read(void* to, std::size_t size, std::uint64_t offset) const {
  auto* next = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = pread(file_, next, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(path_ + ": cannot be read (" + std::strerror(errno) + ")");
    if (got == 0) throw InputError(path_ + ": the file has become shorter during the run");
    next += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
}

PositionedFile::State PositionedFile::state() const {
  struct stat now {};
  if (fstat(file_, &now) != 0) throw InputError(path_ + ": cannot be read (" + std::strerror(errno) + ")");
  return {now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec};
}

void PositionedFile::expect_unchanged() const {
  if (state() != at_first_) throw InputError(path_ + ": the file changed during the run");
}

}  // namespace podm
