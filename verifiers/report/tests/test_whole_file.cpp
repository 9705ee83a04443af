// Files that are left after an attempt to write a report fails or is interrupted.
#include "report/whole_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "errors.h"

namespace podm::verify {
namespace {

// Called when a file or folder is synced to the disk; an error number makes the sync fail.
std::function<int(const struct stat&)> on_sync;

}  // namespace
}  // namespace podm::verify

// Replaces the system's fsync in this program.
extern "C" int fsync(int descriptor) {
  struct stat status;
  if (podm::verify::on_sync && ::fstat(descriptor, &status) == 0) {
    errno = podm::verify::on_sync(status);
    if (errno != 0) return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

namespace podm::verify {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

class WholeFile : public testing::Test {
 protected:
  WholeFile() {
    std::string pattern = (fs::temp_directory_path() / "podm-verify-test-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    make("report", "older");
  }
  ~WholeFile() override {
    on_sync = nullptr;
    fs::remove_all(folder_);
  }

  std::string path_of(const std::string& name) const { return folder_ / name; }
  void make(const std::string& name, const std::string& text) const { std::ofstream(path_of(name)) << text; }
  void write() const { write_whole_file(path_of("report"), "newer"); }

  Files files() const {
    Files found;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      found[entry.path().filename()] = text.str();
    }
    return found;
  }

  static std::string of_process(pid_t process) { return "report.tmp" + std::to_string(process) + "-3"; }

  fs::path folder_;
};

TEST_F(WholeFile, TakesThePlaceOfAnOlderOne) {
  write();
  EXPECT_EQ(files(), (Files{{"report", "newer"}}));
}

// Returns the status of a process that gets the signal with all bytes written and none synced to the disk.
template <class Action>
int status_after(int number, const Action& write) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::signal(number, SIG_DFL);  // sanitizers handle crashes
    on_sync = [number](const struct stat&) {
      ::kill(::getpid(), number);
      return 0;
    };
    write();
    ::_exit(0);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

TEST_F(WholeFile, SignalsRemoveWhatIsUnfinished) {
  for (const int number :
       {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGALRM, SIGXCPU, SIGPROF, SIGABRT, SIGRTMIN, SIGRTMAX}) {
    const int status = status_after(number, [&] { write(); });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number) << number;
    EXPECT_EQ(files(), (Files{{"report", "older"}})) << number;
  }
}

TEST_F(WholeFile, SignalsThatEndNothingAndThoseIgnoredChangeNothing) {
  for (const int number : {SIGCHLD, SIGWINCH, SIGCONT}) {
    make("report", "older");
    EXPECT_EQ(status_after(number, [&] { write(); }), 0) << number;
    EXPECT_EQ(files(), (Files{{"report", "newer"}})) << number;
  }
  make("report", "older");
  const int status = status_after(SIGHUP, [&] {
    ::signal(SIGHUP, SIG_IGN);
    write();
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(files(), (Files{{"report", "newer"}}));
}

TEST_F(WholeFile, SignalsAfterwardsAreAsBefore) {
  write();
  struct sigaction action;
  ::sigaction(SIGTERM, nullptr, &action);
  EXPECT_EQ(action.sa_handler, SIG_DFL);
}

TEST_F(WholeFile, AFullDiskKeepsTheOlderOne) {
  on_sync = [](const struct stat&) { return ENOSPC; };
  try {
    write();
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), path_of("report") + ": cannot be written: No space left on device");
  }
  EXPECT_EQ(files(), (Files{{"report", "older"}}));
}

TEST_F(WholeFile, IsOnTheDiskBeforeItHasItsNameAndItsNameAfterwards) {
  std::vector<std::pair<bool, std::string>> synced;
  on_sync = [&](const struct stat& status) {
    synced.emplace_back(S_ISDIR(status.st_mode), files().at("report"));
    return 0;
  };
  write();
  EXPECT_EQ(synced, (std::vector<std::pair<bool, std::string>>{{false, "older"}, {true, "newer"}}));
}

TEST_F(WholeFile, WhatKilledProcessesLeftGoes) {
  EXPECT_EQ(status_after(SIGKILL, [&] { write(); }), SIGKILL);
  EXPECT_EQ(files().size(), 2u) << "the older one, and what is left";
  make(of_process(1), "the number is that of another process now");
  const Files others{{"report.tmp", ""},
                     {"report.tmp12", ""},
                     {"report.tmp1-x", ""},
                     {"report.tmp1-2x", ""},
                     {"report2.tmp1-3", ""}};
  for (const auto& [name, text] : others) make(name, text);
  write();
  Files expected = others;
  expected["report"] = "newer";
  EXPECT_EQ(files(), expected);
}

TEST_F(WholeFile, WhatAnotherProcessWritesIsLocked) {
  make(of_process(1), "");
  const int descriptor = ::open(path_of(of_process(1)).c_str(), O_WRONLY);
  ASSERT_EQ(::flock(descriptor, LOCK_EX), 0);
  write();
  EXPECT_EQ(files(), (Files{{"report", "newer"}, {of_process(1), ""}}));
  ::close(descriptor);
}

TEST_F(WholeFile, IsLockedUntilItHasItsName) {
  int error_number = 0;
  on_sync = [&](const struct stat& status) {
    if (!S_ISREG(status.st_mode)) return 0;
    for (const auto& [name, text] : files()) {
      if (name == "report") continue;
      const int descriptor = ::open(path_of(name).c_str(), O_WRONLY);
      error_number = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
      ::close(descriptor);
    }
    return 0;
  };
  write();
  EXPECT_EQ(error_number, EWOULDBLOCK);
}

}  // namespace
}  // namespace podm::verify
