#include "files/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <vector>

#include "files/leftovers.h"
#include "podm/errors.h"

namespace podm {
namespace {

constexpr std::string_view kMark = ".tmp";  // then the process, a dash and a number

std::string resolve_target(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return path;
  if (std::filesystem::is_directory(status)) fail_to_write(path, EISDIR);
  if (!std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("cannot write {}: not a regular file", path));
  if (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)  // rename would not ask
    fail_to_write(path, errno);
  return std::filesystem::canonical(path).string();
}

// With the slash at its end; empty: the working folder.
std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/') + 1); }

struct OldTemporary {
  std::string path;
  pid_t process;
};

// The process in "TARGET.tmpPROCESS-NUMBER"; 0: another name.
pid_t process_of(std::string_view name) {
  const std::size_t mark = name.rfind(kMark);
  if (mark == std::string_view::npos) return 0;
  const char* const end = name.data() + name.size();
  pid_t process = 0;
  unsigned number = 0;
  const auto dash = std::from_chars(name.data() + mark + kMark.size(), end, process);
  if (dash.ec != std::errc() || dash.ptr == end || *dash.ptr != '-' || process <= 0) return 0;
  const auto last = std::from_chars(dash.ptr + 1, end, number);
  return last.ec == std::errc() && last.ptr == end ? process : 0;
}

// By target. A folder is looked through once a process: there may be a file a label, and many others.
std::vector<OldTemporary> take_old_temporaries(const std::string& target, const HeldLeftovers&) {
  static auto& folders = *new std::set<std::string>;
  static auto& found = *new std::map<std::string, std::vector<OldTemporary>>;
  const std::string folder = folder_of(target);
  std::error_code error;
  if (folders.insert(folder).second) {
    const std::string listed = folder.empty() ? "." : folder;
    for (auto entry = std::filesystem::directory_iterator(listed, error);
         !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      if (const pid_t process = process_of(name); process != 0)
        found[folder + name.substr(0, name.rfind(kMark))].push_back({folder + name, process});
    }
  }
  const auto node = found.extract(target);
  return node ? std::move(node.mapped()) : std::vector<OldTemporary>{};
}

// The process is gone and no other, on another machine or in another container, has a lock on the file.
void remove_if_abandoned(const OldTemporary& old, const HeldLeftovers& ours) {
  if (ours.has(old.path)) return;
  if (old.process != ::getpid() && (::kill(old.process, 0) == 0 || errno != ESRCH)) return;
  const int descriptor = ::open(old.path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status;
  const bool is_file = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const bool is_locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (is_file && !is_locked) ::unlink(old.path.c_str());
  ::close(descriptor);
}

// EINVAL: the file system has nothing to wait for.
int sync_error(int descriptor) { return ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno; }

}  // namespace

void fail_to_write(const std::string& path, int error_number) {
  throw InputError(fmt::format("cannot write {}: {}", path, std::generic_category().message(error_number)));
}

TemporaryFile::TemporaryFile(const std::string& path) : path_(path), target_(resolve_target(path)) {
  static unsigned next_number = 0;
  HeldLeftovers leftovers;
  for (const OldTemporary& old : take_old_temporaries(target_, leftovers))
    remove_if_abandoned(old, leftovers);
  int error_number = 0;
  do {  // not mkstemp: it makes files that only the owner may read
    temporary_ = fmt::format("{}{}{}-{}", target_, kMark, ::getpid(), next_number++);
    leftovers.add(temporary_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    error_number = errno;
    if (descriptor_ < 0) leftovers.drop(temporary_);
  } while (descriptor_ < 0 && error_number == EEXIST);
  if (descriptor_ < 0) fail_to_write(path_, error_number);
  ::flock(descriptor_, LOCK_EX | LOCK_NB);  // where the file system has locks
}

TemporaryFile::~TemporaryFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  HeldLeftovers leftovers;
  ::unlink(temporary_.c_str());
  leftovers.drop(temporary_);
}

void TemporaryFile::write(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void TemporaryFile::close() {
  if (descriptor_ < 0) return;
  // Network and quota file systems report a full disk only here.
  if (const int error_number = sync_error(descriptor_); error_number != 0) fail_to_write(path_, error_number);
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail_to_write(path_, errno);
}

void TemporaryFile::publish(std::span<TemporaryFile* const> files) {
  for (TemporaryFile* file : files) file->close();
  {
    HeldLeftovers leftovers;
    for (TemporaryFile* file : files) {
      if (::rename(file->temporary_.c_str(), file->target_.c_str()) != 0) fail_to_write(file->path_, errno);
      leftovers.drop(file->temporary_);
      file->temporary_.clear();
    }
  }
  std::set<std::string> folders;
  for (const TemporaryFile* file : files)
    if (folders.insert(folder_of(file->target_)).second) file->sync_folder();
}

// Else a new name might not outlive a power cut, nor an old one be gone.
void TemporaryFile::sync_folder() const {
  const std::string folder = folder_of(target_);
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // one may write there, not read
  const int error_number = sync_error(descriptor);
  ::close(descriptor);
  if (error_number != 0) fail_to_write(path_, error_number);
}

}  // namespace podm
