#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "podm/errors.h"
#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

TEST(AtomicFile, AppearsOnlyWhenPublished) {
  const ScratchFolder folder;
  {
    AtomicFile file(folder / "a.bin");
    file.put(std::uint32_t{0x64636261});
    file.write("efgh");
    file.write(std::string(1 << 20, 'x'));
    EXPECT_FALSE(folder.files().count("a.bin"));
    file.publish();
    EXPECT_EQ(folder.files(), Names{"a.bin"});
  }
  EXPECT_EQ(folder.read("a.bin"), "abcdefgh" + std::string(1 << 20, 'x'));
}

TEST(AtomicFile, LeavesNothingWhenGivenUp) {
  const ScratchFolder folder;
  {
    AtomicFile file(folder / "a.bin");
    file.write("abc");
    file.finish();
  }
  EXPECT_EQ(folder.files(), Names{});
}

TEST(AtomicFile, HasThePermissionsOfAnyNewFile) {
  const ScratchFolder folder;
  AtomicFile(folder / "a.bin").publish();
  folder.write("b.bin", "");
  struct stat ours, usual;
  ::stat((folder / "a.bin").c_str(), &ours);
  ::stat((folder / "b.bin").c_str(), &usual);
  EXPECT_EQ(ours.st_mode, usual.st_mode);
}

TEST(AtomicFile, ReplacesWhatALinkPointsTo) {
  const ScratchFolder folder;
  folder.write("target.bin", "old");
  std::filesystem::create_symlink("target.bin", folder / "link.bin");
  AtomicFile file(folder / "link.bin");
  file.write("new");
  file.publish();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.bin"));
  EXPECT_EQ(folder.read("target.bin"), "new");
}

TEST(AtomicFile, NamesFileAndFault) {
  const ScratchFolder folder;
  const auto error_of = [](const std::string& path) {
    return fault_of<InputError>([&] { AtomicFile file(path); });
  };
  const std::string missing = folder / "none/a.vtu", under_file = folder / "file/a.vtu";
  folder.write("file", "");
  EXPECT_EQ(error_of(missing), "cannot write " + missing + ": No such file or directory");
  EXPECT_EQ(error_of(under_file), "cannot write " + under_file + ": Not a directory");
  EXPECT_EQ(error_of("/dev/full"), "cannot write /dev/full: not a regular file");
  std::filesystem::create_directory(folder / "d.vtu");
  EXPECT_EQ(error_of(folder / "d.vtu"), "cannot write " + (folder / "d.vtu") + ": Is a directory");
}

// While an object lives, root, which may write everywhere, has the rights of an unprivileged user; any other
// user is unchanged.
class OrdinaryUser {
 public:
  OrdinaryUser() : user_(::geteuid()) { EXPECT_EQ(::seteuid(user_ == 0 ? 65534 : user_), 0); }
  ~OrdinaryUser() { EXPECT_EQ(::seteuid(user_), 0); }

 private:
  uid_t user_;
};

TEST(AtomicFile, RefusesAFolderAndAFileWithoutWritePermission) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.vtu", "old"), new_path = folder / "b.vtu";
  ::chmod(path.c_str(), 0444);
  ::chmod((folder / "").c_str(), 0555);
  {
    const OrdinaryUser user;
    for (const std::string& refused : {path, new_path}) {
      EXPECT_EQ(fault_of<InputError>([&] { AtomicFile file(refused); }),
                "cannot write " + refused + ": Permission denied");
    }
  }
  ::chmod((folder / "").c_str(), 0755);
  EXPECT_EQ(folder.files(), Names{"a.vtu"});
}

}  // namespace
}  // namespace podm
