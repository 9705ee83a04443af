// What other processes left of a file, and that a new name reaches the disk.
#include "files/temporary_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <functional>

#include "files/atomic_file.h"
#include "io/tests/scratch_folder.h"
#include "podm/errors.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

// Asked of every file that is brought to the disk; an error number ends the attempt.
std::function<int(const struct stat&)> on_sync;

}  // namespace
}  // namespace podm

// Takes the place of the system's in this program.
extern "C" int fsync(int descriptor) {
  struct stat status;
  if (podm::on_sync && ::fstat(descriptor, &status) == 0) {
    errno = podm::on_sync(status);
    if (errno != 0) return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

namespace podm {
namespace {

class TemporaryFiles : public testing::Test {
 protected:
  ~TemporaryFiles() override { on_sync = nullptr; }

  void make(const std::string& name) const { std::ofstream(folder_ / name) << "older"; }
  void write(const std::string& name) const { AtomicFile(folder_ / name).publish(); }

  static std::string of_process(const std::string& name, pid_t process) {
    return name + ".tmp" + std::to_string(process) + "-0";
  }

  const ScratchFolder folder_;
};

// Of a process that is no more.
pid_t gone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

TEST_F(TemporaryFiles, WhatProcessesThatAreGoneLeftOfTheSameFileGoes) {
  const pid_t process = gone();
  make(of_process("a", process));
  make("a.tmp" + std::to_string(process) + "-17");
  Names others{of_process("b", process),
               of_process("a.b", process),
               "a.tmp" + std::to_string(process),
               of_process("a", process) + "x",
               "a.tmp-1-0",
               "a.tmp0-0",
               "a.tmp-0",
               of_process("a", ::getppid())};
  for (const std::string& name : others) make(name);
  write("a");
  others.insert("a");
  EXPECT_EQ(folder_.files(), others);
}

// In a container the numbers are used again at once.
TEST_F(TemporaryFiles, WhatAnEarlierProcessOfTheSameNumberLeftGoes) {
  make("a.tmp" + std::to_string(::getpid()) + "-4000000");
  const AtomicFile ours(folder_ / "b");
  make("b.tmp" + std::to_string(::getpid()) + "-4000000");
  AtomicFile again(folder_ / "b");
  write("a");
  EXPECT_EQ(folder_.files().size(), 4u)
      << "both of b, one that was left after the folder was looked through, a";
}

TEST_F(TemporaryFiles, WhatAnotherMachineWritesIsLocked) {
  const std::string name = of_process("a", gone());
  make(name);
  const int descriptor = ::open((folder_ / name).c_str(), O_WRONLY);
  ASSERT_EQ(::flock(descriptor, LOCK_EX), 0);
  write("a");
  EXPECT_EQ(folder_.files(), (Names{"a", name}));
  ::close(descriptor);
}

TEST_F(TemporaryFiles, IsLocked) {
  const TemporaryFile file(folder_ / "a");
  const int descriptor = ::open((folder_ / *folder_.files().begin()).c_str(), O_WRONLY);
  EXPECT_NE(::flock(descriptor, LOCK_EX | LOCK_NB), 0);
  ::close(descriptor);
}

TEST_F(TemporaryFiles, TheFolderIsBroughtToTheDiskAfterItsNewNames) {
  std::vector<Names> at_sync_of_folder;
  Names at_sync_of_file;
  struct stat folder;
  ASSERT_EQ(::stat((folder_ / "").c_str(), &folder), 0);
  on_sync = [&](const struct stat& synced) {
    if (S_ISREG(synced.st_mode)) at_sync_of_file.merge(folder_.files());
    if (synced.st_ino == folder.st_ino) at_sync_of_folder.push_back(folder_.files());
    return 0;
  };
  std::deque<AtomicFile> files;
  files.emplace_back(folder_ / "a");
  files.emplace_back(folder_ / "b");
  publish_together(files);
  EXPECT_EQ(at_sync_of_folder, std::vector{(Names{"a", "b"})});
  EXPECT_FALSE(at_sync_of_file.empty());
  EXPECT_FALSE(at_sync_of_file.contains("a") || at_sync_of_file.contains("b"));
}

TEST_F(TemporaryFiles, AFolderThatDoesNotReachTheDiskIsReported) {
  on_sync = [](const struct stat& synced) { return S_ISDIR(synced.st_mode) ? EIO : 0; };
  try {
    write("a");
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "cannot write " + (folder_ / "a") + ": Input/output error");
  }
  on_sync = [](const struct stat& synced) { return S_ISDIR(synced.st_mode) ? EINVAL : 0; };
  write("b");  // a file system that cannot
}

TEST_F(TemporaryFiles, ADiskThatIsFullOnlyWhenAskedKeepsTheOlderFile) {
  make("a");
  on_sync = [](const struct stat& synced) { return S_ISREG(synced.st_mode) ? ENOSPC : 0; };
  EXPECT_THROW(write("a"), InputError);
  EXPECT_EQ(folder_.files(), Names{"a"});
  std::string text;
  std::getline(std::ifstream(folder_ / "a"), text);
  EXPECT_EQ(text, "older");
}

}  // namespace
}  // namespace podm
