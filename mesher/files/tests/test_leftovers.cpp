// What is left when a process ends itself: in a child process, for nobody goes on after that.
#include "files/leftovers.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include "files/atomic_file.h"
#include "io/tests/scratch_folder.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

// Ends itself by _exit(): destructors would wait for ever.
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
    AtomicFile published(folder / "published"), closed(folder / "closed"), open(folder / "open");
    for (AtomicFile* file : {&published, &closed, &open}) file->write("text");
    published.publish();
    closed.close();
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
