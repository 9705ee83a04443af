// Checks what remains when a process ends itself. Runs in a child process, because the process ends.
#include "files/leftovers.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include "files/atomic_file.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

// `action` ends the child by _exit(): destructors would wait for ever.
template <class Action>
void in_a_child(const Action& action) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) action();
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(Leftovers, FilesAndFoldersGoButNotWhatIsPublished) {
  const ScratchFolder folder;
  in_a_child([&] {
    AtomicFile published(folder / "published"), finished(folder / "finished"), open(folder / "open");
    for (AtomicFile* file : {&published, &finished, &open}) file->write("text");
    published.publish();
    finished.finish();
    std::filesystem::create_directories(folder / "scratch/inner");
    std::ofstream(folder / "scratch/inner/file") << "text";
    std::ofstream(folder / "dropped") << "text";
    {
      HeldLeftovers leftovers;
      leftovers.add(folder / "scratch");
      leftovers.add(folder / "never made");
      leftovers.add(folder / "dropped");
      leftovers.drop(folder / "dropped");
    }
    remove_leftovers_for_good();
    _exit(0);
  });
  EXPECT_EQ(folder.files(), (Names{"published", "dropped"}));
}

TEST(Leftovers, NoFileIsMadeNorNamedAfterwards) {
  const ScratchFolder folder;
  in_a_child([&] {
    std::deque<AtomicFile> pair;
    pair.emplace_back(folder / "first");
    pair.emplace_back(folder / "second");
    remove_leftovers_for_good();
    std::thread([&] { AtomicFile(folder / "third").publish(); }).detach();
    std::thread([&] { publish_together(pair); }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    _exit(0);
  });
  EXPECT_EQ(folder.files(), Names{});
}

TEST(Leftovers, ChildrenAreKilledButNotThoseThatWereWaitedFor) {
  in_a_child([&] {
    const auto start = [] {
      HeldLeftovers leftovers;
      const pid_t child = fork();
      if (child == 0)
        for (;;) pause();
      leftovers.add_child(child);
      return child;
    };
    const pid_t kept = start(), dropped = start();
    HeldLeftovers().drop_child(dropped);
    remove_leftovers_for_good();
    int status = 0;
    const bool is_killed = waitpid(kept, &status, 0) == kept && WIFSIGNALED(status);
    const bool lives = waitpid(dropped, &status, WNOHANG) == 0;
    kill(dropped, SIGKILL);
    _exit(is_killed && lives ? 0 : 1);
  });
}

TEST(Leftovers, WhoeverHoldsThemForEverIsNotWaitedFor) {
  in_a_child([] {
    alarm(10);
    const HeldLeftovers held;
    std::thread([] {
      const auto start = std::chrono::steady_clock::now();
      remove_leftovers_for_good();
      _exit(std::chrono::steady_clock::now() - start < std::chrono::seconds(1) ? 0 : 1);
    }).join();
  });
}

TEST(Leftovers, WhoeverHoldsThemIsWaitedFor) {
  const ScratchFolder folder;
  in_a_child([&] {
    const std::string path = folder / "halves";
    std::optional<HeldLeftovers> held(std::in_place);
    std::thread end([] {
      remove_leftovers_for_good();
      _exit(0);
    });
    std::ofstream(path) << "one";
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    std::ofstream(path, std::ios::app) << " whole";
    held.reset();
    end.join();
  });
  std::string text;
  std::getline(std::ifstream(folder / "halves"), text);
  EXPECT_EQ(text, "one whole");
}

}  // namespace
}  // namespace podm
