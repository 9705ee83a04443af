#include "files/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <set>
#include <system_error>

#include "files/leftovers.h"
#include "podm/errors.h"

namespace podm {
namespace {

std::string resolve_target(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return path;
  if (std::filesystem::is_directory(status)) fail_to_write(path, EISDIR);
  if (!std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("cannot write {}: not a regular file", path));
  if (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)  // rename() would not check this
    fail_to_write(path, errno);
  return std::filesystem::canonical(path).string();
}

// mkstemp() is unsuitable: only the owner may read the files that it makes.
int make_file(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }

int make_folder(const char* path) {
  return ::mkdir(path, 0777) != 0 ? -1 : ::open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

// EINVAL: the file system has nothing to wait for.
int sync_error(int descriptor) { return ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno; }

}  // namespace

void fail_to_write(const std::string& path, int error_number) {
  throw InputError(fmt::format("cannot write {}: {}", path, std::generic_category().message(error_number)));
}

TemporaryFile::TemporaryFile(const std::string& path)
    : path_(path), target_(resolve_target(path)), temporary_(make_temporary(target_, make_file)) {
  if (temporary_.descriptor < 0) fail_to_write(path_, temporary_.error_number);
}

TemporaryFile::~TemporaryFile() {
  if (temporary_.descriptor >= 0) ::close(temporary_.descriptor);
  if (temporary_.path.empty()) return;
  HeldLeftovers leftovers;
  ::unlink(temporary_.path.c_str());
  leftovers.drop(temporary_.path);
}

int TemporaryFile::new_descriptor() const {
  const int descriptor = ::dup(temporary_.descriptor);
  if (descriptor < 0) fail_to_write(path_, errno);
  return descriptor;
}

void TemporaryFile::write(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(temporary_.descriptor, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void TemporaryFile::finish() {
  if (is_finished_) return;
  // Network and quota file systems report a full disk only here.
  if (const int error_number = sync_error(temporary_.descriptor); error_number != 0)
    fail_to_write(path_, error_number);
  is_finished_ = true;
  // The file stays open, and therefore locked, until it has its name. It is closed earlier only when half of
  // the descriptors are in use, as with the surfaces of a great number of labels.
  if (temporary_.descriptor < ::sysconf(_SC_OPEN_MAX) / 2) return;
  ::close(temporary_.descriptor);
  temporary_.descriptor = -1;
}

void TemporaryFile::publish(std::span<TemporaryFile* const> files) {
  for (TemporaryFile* file : files) file->finish();
  {
    HeldLeftovers leftovers;
    for (TemporaryFile* file : files) {
      std::string& temporary = file->temporary_.path;
      if (::rename(temporary.c_str(), file->target_.c_str()) != 0) fail_to_write(file->path_, errno);
      leftovers.drop(temporary);
      temporary.clear();
    }
  }
  std::set<std::string> folders;
  for (const TemporaryFile* file : files)
    if (folders.insert(folder_of(file->target_)).second) file->sync_folder();
}

// Without this, a new name might be lost in a power cut, or an old one might survive it.
void TemporaryFile::sync_folder() const {
  const std::string folder = folder_of(target_);
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // the process may write there, but not read
  const int error_number = sync_error(descriptor);
  ::close(descriptor);
  if (error_number != 0) fail_to_write(path_, error_number);
}

SharedFile::SharedFile(const std::string& file, const std::string& path)
    : path_(path), descriptor_(::open(file.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail_to_write(path, errno);
}

SharedFile::~SharedFile() { ::close(descriptor_); }

void SharedFile::write(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    offset += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void SharedFile::finish() {
  if (const int error_number = sync_error(descriptor_); error_number != 0) fail_to_write(path_, error_number);
}

TemporaryFolder::TemporaryFolder(const std::string& path)
    : temporary_(make_temporary(resolve_target(path), make_folder)) {
  if (temporary_.descriptor < 0) fail_to_write(path, temporary_.error_number);
}

TemporaryFolder::~TemporaryFolder() {
  HeldLeftovers leftovers;
  remove_file_or_folder(temporary_.path);
  leftovers.drop(temporary_.path);
  ::close(temporary_.descriptor);
}

}  // namespace podm
