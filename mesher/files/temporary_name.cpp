#include "files/temporary_name.h"

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
#include <string_view>
#include <system_error>
#include <vector>

#include "files/leftovers.h"

namespace podm {
namespace {

constexpr std::string_view kMark = ".tmp";  // followed by the process, a dash and a number

struct OldTemporary {
  std::string path;
  pid_t process;
};

// Returns the process in "TARGET.tmpPROCESS-NUMBER"; 0 for another name.
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

using OldByTarget = std::map<std::string, std::vector<OldTemporary>>;

// Returns the old temporaries of the folders searched so far, this one included. A folder is searched once
// per process, because it may contain one file per label and many other files.
OldByTarget& old_temporaries(const std::string& folder, const HeldLeftovers&) {
  static auto& folders = *new std::set<std::string>;
  static auto& found = *new OldByTarget;
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
  return found;
}

// Takes the old temporaries of `target` from those found.
std::vector<OldTemporary> take_old_temporaries(const std::string& target, const HeldLeftovers& leftovers) {
  const auto node = old_temporaries(folder_of(target), leftovers).extract(target);
  return node ? std::move(node.mapped()) : std::vector<OldTemporary>{};
}

enum class Lock { kOurs, kOfAnother, kImpossible };

Lock try_lock(int descriptor) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return Lock::kOurs;
  return errno == EWOULDBLOCK ? Lock::kOfAnother : Lock::kImpossible;
}

// A process locks a temporary before it removes it. A temporary that this process has locked and that still
// has its name therefore keeps the name.
bool has_name(int descriptor, const std::string& path) {
  struct stat opened, named;
  return ::fstat(descriptor, &opened) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

int open_to_lock(const char* path) {
  constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const int file = ::open(path, O_RDWR | kFlags);  // network file systems lock only writable files
  return file < 0 && errno == EISDIR ? ::open(path, O_RDONLY | O_DIRECTORY | kFlags) : file;
}

bool is_file_or_folder(int descriptor) {
  struct stat status;
  return ::fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
}

// Removes a temporary that no process, on this machine or another, in this container or another, has locked.
// Its process number decides only where there are no locks, because the number of an ended process is soon
// reused.
void remove_if_abandoned(const OldTemporary& old, const HeldLeftovers& ours) {
  if (ours.has(old.path)) return;
  const int descriptor = open_to_lock(old.path.c_str());
  if (descriptor < 0) return;
  const Lock lock = try_lock(descriptor);
  const bool is_process_gone = old.process == ::getpid() || (::kill(old.process, 0) != 0 && errno == ESRCH);
  const bool is_abandoned = lock == Lock::kOurs || (lock == Lock::kImpossible && is_process_gone);
  if (is_abandoned && is_file_or_folder(descriptor) && has_name(descriptor, old.path))
    remove_file_or_folder(old.path);
  ::close(descriptor);
}

// False if another process found the temporary before it was locked.
bool is_kept(const Temporary& made) {
  const Lock lock = try_lock(made.descriptor);
  return lock == Lock::kImpossible || (lock == Lock::kOurs && has_name(made.descriptor, made.path));
}

}  // namespace

Temporary make_temporary(const std::string& target, int (*make)(const char* path)) {
  static unsigned next_number = 0;
  HeldLeftovers leftovers;
  for (const OldTemporary& old : take_old_temporaries(target, leftovers)) remove_if_abandoned(old, leftovers);
  for (;;) {
    Temporary made{.path = fmt::format("{}{}{}-{}", target, kMark, ::getpid(), next_number++)};
    leftovers.add(made.path);
    made.descriptor = make(made.path.c_str());
    made.error_number = made.descriptor < 0 ? errno : 0;
    if (made.descriptor >= 0 && is_kept(made)) return made;
    leftovers.drop(made.path);
    if (made.descriptor >= 0) ::close(made.descriptor);
    if (made.error_number != 0 && made.error_number != EEXIST) return {{}, -1, made.error_number};
  }
}

void remove_old_temporaries(const std::string& folder,
                            const std::function<bool(const std::string& target)>& is_target) {
  const HeldLeftovers leftovers;
  for (const auto& [target, all] : old_temporaries(folder, leftovers))
    if (folder_of(target) == folder && is_target(target))
      for (const OldTemporary& old : all) remove_if_abandoned(old, leftovers);
}

std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/') + 1); }

}  // namespace podm
