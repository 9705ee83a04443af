#include "report/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <system_error>
#include <vector>

#include "errors.h"

namespace podm::verify {
namespace {

namespace fs = std::filesystem;

// The path that a signal handler removes before it ends the program. A handler may only access lock-free
// atomics.
std::atomic<const char*> unfinished = nullptr;
static_assert(std::atomic<const char*>::is_always_lock_free);

extern "C" void remove_unfinished(int number) {
  if (const char* path = unfinished) ::unlink(path);
  std::signal(number, SIG_DFL);
  std::raise(number);
  sigset_t only;
  ::sigemptyset(&only);
  ::sigaddset(&only, number);
  ::pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  ::_exit(128 + number);  // the first process of a container survives its own signals
}

// While an object lives, signals that end the program first remove its path.
class RemovedBySignals {
 public:
  explicit RemovedBySignals(const char* path) {
    unfinished = path;
    struct sigaction removes {};
    removes.sa_handler = remove_unfinished;
    ::sigfillset(&removes.sa_mask);
    for (int number = 1; number <= SIGRTMAX; ++number) {
      struct sigaction before;
      if (!ends_by_default(number) || ::sigaction(number, nullptr, &before) != 0) continue;
      if (before.sa_handler == SIG_DFL && ::sigaction(number, &removes, nullptr) == 0)
        numbers_.push_back(number);
    }
  }
  ~RemovedBySignals() {
    for (const int number : numbers_) std::signal(number, SIG_DFL);
    unfinished = nullptr;
  }
  RemovedBySignals(const RemovedBySignals&) = delete;
  RemovedBySignals& operator=(const RemovedBySignals&) = delete;

 private:
  static bool ends_by_default(int number) {
    switch (number) {
      case SIGCHLD:
      case SIGCONT:
      case SIGTSTP:
      case SIGTTIN:
      case SIGTTOU:
      case SIGURG:
      case SIGWINCH:
        return false;
      default:
        return true;
    }
  }

  std::vector<int> numbers_;
};

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return number_; }

 private:
  int number_;
};

bool is_regular_file_at(int descriptor, const std::string& path) {
  struct stat opened, named;
  return ::fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) && ::lstat(path.c_str(), &named) == 0 &&
         named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
}

// True if the calling process may write or remove the unfinished file. `otherwise` is the answer on file
// systems without locks.
bool locks(int descriptor, const std::string& path, bool otherwise) {
  const bool is_locked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  if (!is_locked && errno == EWOULDBLOCK) return false;
  return (is_locked || otherwise) && is_regular_file_at(descriptor, path);
}

// Returns the process in a name "NAME.tmpPROCESS-NUMBER", where `prefix` is "NAME.tmp"; 0 for any other name.
int process_of(const std::string& name, const std::string& prefix) {
  if (!name.starts_with(prefix)) return 0;
  const std::size_t dash = name.find('-', prefix.size());
  const auto number_in = [&](std::size_t begin, std::size_t end) {
    int number = -1;
    const auto parsed = std::from_chars(name.data() + begin, name.data() + end, number);
    return parsed.ec == std::errc() && parsed.ptr == name.data() + end ? number : -1;
  };
  if (dash == std::string::npos || number_in(dash + 1, name.size()) < 0) return 0;
  return std::max(0, number_in(prefix.size(), dash));
}

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder;
}

void remove_abandoned(const std::string& path) {
  const std::string prefix = fs::path(path).filename().string() + ".tmp";
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder_of(path), error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const int process = process_of(entry->path().filename().string(), prefix);
    if (process == 0) continue;
    const std::string found = entry->path().string();
    const bool is_gone = process == ::getpid() || (::kill(process, 0) != 0 && errno == ESRCH);
    const Descriptor file(::open(found.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file >= 0 && locks(file, found, is_gone)) ::unlink(found.c_str());
  }
}

void write_all(int descriptor, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno != EINTR) refuse_to_write(path, errno);
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// Waits until the written bytes are on the disk. EINVAL means that the file system has nothing to wait for.
void sync(int descriptor, const std::string& path) {
  if (::fsync(descriptor) != 0 && errno != EINVAL) refuse_to_write(path, errno);
}

// Returns false if `temporary` exists, or if another process took the new file for abandoned.
bool try_to_write(const std::string& path, const std::string& temporary, std::string_view text) {
  const RemovedBySignals removed(temporary.c_str());
  const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file < 0 && errno == EEXIST) return false;
  if (file < 0) refuse_to_write(path, errno);
  if (!locks(file, temporary, true)) return false;
  try {
    write_all(file, text, path);
    sync(file, path);
    if (::rename(temporary.c_str(), path.c_str()) != 0) refuse_to_write(path, errno);
  } catch (const InputError&) {
    ::unlink(temporary.c_str());
    throw;
  }
  return true;
}

}  // namespace

void write_whole_file(const std::string& path, std::string_view text) {
  remove_abandoned(path);
  for (int number = 0; !try_to_write(path, fmt::format("{}.tmp{}-{}", path, ::getpid(), number), text);)
    ++number;
  // Without this the new name might not survive a power cut.
  const Descriptor folder(::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder >= 0) sync(folder, path);  // negative if the folder may be written but not read
}

void refuse_to_write(const std::string& path, int error_number) {
  throw InputError(
      fmt::format("{}: cannot be written: {}", path, std::generic_category().message(error_number)));
}

}  // namespace podm::verify
