#include "io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "podm/errors.h"

namespace podm {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw InputError(fmt::format("cannot write {}: {}", path, reason));
}

[[noreturn]] void fail(const std::string& path, int error_number) {
  fail(path, std::generic_category().message(error_number));
}

std::string resolve_target(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return path;
  if (std::filesystem::is_directory(status)) fail(path, EISDIR);
  if (!std::filesystem::is_regular_file(status)) fail(path, "not a regular file");
  if (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) fail(path, errno);  // rename would not ask
  return std::filesystem::canonical(path).string();
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path)
    : path_(path), target_(resolve_target(path)), buffer_(new char[kBufferBytes]) {
  static std::atomic<unsigned> next_suffix{0};
  do {  // not mkstemp: it makes files that only the owner may read
    temporary_ = fmt::format("{}.tmp{}-{}", target_, ::getpid(), next_suffix++);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) fail(path_, errno);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  if (buffered_ + size > kBufferBytes) flush();
  if (size > kBufferBytes) return write_through(from, size);
  std::memcpy(buffer_.get() + buffered_, from, size);
  buffered_ += size;
}

void AtomicFile::flush() {
  write_through(buffer_.get(), buffered_);
  buffered_ = 0;
}

void AtomicFile::write_through(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, errno);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void AtomicFile::close() {
  if (descriptor_ < 0) return;
  flush();
  // Network and quota file systems report a full disk only here.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(path_, errno);
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail(path_, errno);
  buffer_.reset();
}

void AtomicFile::publish() {
  close();
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
  temporary_.clear();
}

void publish_together(std::deque<AtomicFile>& files) {
  for (AtomicFile& file : files) file.close();
  for (AtomicFile& file : files) file.publish();
}

}  // namespace podm
