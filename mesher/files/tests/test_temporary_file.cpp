// Checks that files which ended processes left behind are removed, and that a new name reaches the disk.
#include "files/temporary_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <functional>

#include "files/atomic_file.h"
#include "podm/errors.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

// Called for every file that is written to the disk, and before a file is locked. A returned error number
// ends the attempt.
std::function<int(const struct stat&)> on_sync;
std::function<int()> on_lock;

}  // namespace
}  // namespace podm

// These functions replace the system's in this program.
extern "C" int flock(int descriptor, int operation) noexcept {
  if (podm::on_lock) {
    errno = podm::on_lock();
    if (errno != 0) return -1;
  }
  return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
}

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
  ~TemporaryFiles() override {
    on_sync = nullptr;
    on_lock = nullptr;
  }

  void make(const std::string& name) const { std::ofstream(folder_ / name) << "older"; }
  void write(const std::string& name) const { AtomicFile(folder_ / name).publish(); }

  static std::string of_process(const std::string& name, pid_t process) {
    return name + ".tmp" + std::to_string(process) + "-0";
  }

  const ScratchFolder folder_;
};

// Returns the number of a process that has ended.
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
               "a.tmp-0"};
  for (const std::string& name : others) make(name);
  write("a");
  others.insert("a");
  EXPECT_EQ(folder_.files(), others);
}

// Locks decide, because another process may have its number by now.
TEST_F(TemporaryFiles, FilesThatNoProcessHasLockedGoAlthoughAProcessOfThatNumberLives) {
  make(of_process("a", ::getppid()));
  make(of_process("a", 1));
  write("a");
  EXPECT_EQ(folder_.files(), Names{"a"});
}

TEST_F(TemporaryFiles, WithoutLocksWhatProcessesLeftThatAreGoneGoes) {
  on_lock = [] { return ENOLCK; };
  make(of_process("a", gone()));
  make(of_process("a", ::getppid()));
  write("a");
  EXPECT_EQ(folder_.files(), (Names{"a", of_process("a", ::getppid())}));
}

TEST_F(TemporaryFiles, AFolderThatWasLeftGoesWithAllItHolds) {
  const std::string left = of_process("a", 1);
  std::filesystem::create_directory(folder_ / left);
  make(left + "/image.nii.gz");
  const TemporaryFolder ours(folder_ / "a");
  make(std::filesystem::path(ours / "image.nii.gz").lexically_relative(folder_ / "").string());
  write("a");
  EXPECT_EQ(folder_.files().size(), 2u) << "a, and the folder that is in use";
  EXPECT_TRUE(std::filesystem::exists(ours / "image.nii.gz"));
}

TEST_F(TemporaryFiles, AFolderGoesAtTheEnd) {
  { std::ofstream(TemporaryFolder(folder_ / "a") / "file") << "text"; }
  {
    const TemporaryFolder folder(folder_ / "a");
    std::ofstream(folder / "file") << "text";
    EXPECT_EQ(folder_.files().size(), 1u);
  }
  EXPECT_EQ(folder_.files(), Names{});
}

// Another process found the temporary before it was locked, and has removed it.
TEST_F(TemporaryFiles, OneThatWasTakenForAbandonedIsMadeAnew) {
  int removed = 0;
  on_lock = [&] {
    for (const std::string& name : folder_.files())
      if (removed == 0) removed += ::unlink((folder_ / name).c_str()) == 0 ? 1 : 0;
    return 0;
  };
  write("a");
  EXPECT_EQ(removed, 1);
  EXPECT_EQ(folder_.files(), Names{"a"});
}

TEST_F(TemporaryFiles, OneThatAnotherProcessIsAboutToRemoveIsMadeAnew) {
  int other = -1;
  on_lock = [&] {
    if (other >= 0) return 0;
    other = ::open((folder_ / *folder_.files().begin()).c_str(), O_WRONLY);
    return static_cast<int>(::syscall(SYS_flock, other, LOCK_EX));
  };
  write("a");
  EXPECT_EQ(folder_.files().size(), 2u) << "a, and what the other has not removed yet";
  EXPECT_TRUE(folder_.files().contains("a"));
  ::close(other);
}

// A container reuses process numbers at once.
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

TEST_F(TemporaryFiles, IsLockedUntilItHasItsName) {
  TemporaryFile file(folder_ / "a");
  file.finish();
  const int descriptor = ::open((folder_ / *folder_.files().begin()).c_str(), O_WRONLY);
  EXPECT_NE(::flock(descriptor, LOCK_EX | LOCK_NB), 0);
  ::close(descriptor);
}

// A mesh has one surface per label.
TEST_F(TemporaryFiles, ThereMayBeMoreThanDescriptors) {
  rlimit before;
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{40, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  std::deque<AtomicFile> files;
  for (int i = 0; i < 100; ++i) files.emplace_back(folder_ / std::to_string(i)).finish();
  publish_together(files);
  EXPECT_EQ(folder_.files().size(), 100u);
  EXPECT_TRUE(folder_.files().contains("99"));
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
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
  write("b");  // a file system without fsync
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
