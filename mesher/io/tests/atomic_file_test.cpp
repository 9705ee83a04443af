#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "io/tests/kuhn_mesh.h"
#include "io/tests/mesh_readers.h"
#include "io/tests/scratch_folder.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

using Names = std::set<std::string>;

// While it lives, no file of this process can grow past `bytes`: to the writer, a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    ::signal(SIGXFSZ, old_handler_);
  }

 private:
  void (*old_handler_)(int);
  rlimit old_;
};

void write_text(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

template <class Call>
std::string input_error_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

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
  EXPECT_EQ(read_bytes(folder / "a.bin"), "abcdefgh" + std::string(1 << 20, 'x'));
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
  write_text(folder / "b.bin", "");
  struct stat ours, usual;
  ::stat((folder / "a.bin").c_str(), &ours);
  ::stat((folder / "b.bin").c_str(), &usual);
  EXPECT_EQ(ours.st_mode, usual.st_mode);
}

TEST(AtomicFile, ReplacesWhatALinkPointsTo) {
  const ScratchFolder folder;
  write_text(folder / "target.bin", "old");
  std::filesystem::create_symlink("target.bin", folder / "link.bin");
  AtomicFile file(folder / "link.bin");
  file.write("new");
  file.publish();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.bin"));
  EXPECT_EQ(read_bytes(folder / "target.bin"), "new");
}

TEST(AtomicFile, NamesFileAndFault) {
  const ScratchFolder folder;
  const auto error_of = [](const std::string& path) {
    return input_error_of([&] { AtomicFile file(path); });
  };
  const std::string missing = folder / "none/a.vtu", under_file = folder / "file/a.vtu";
  write_text(folder / "file", "");
  EXPECT_EQ(error_of(missing), "cannot write " + missing + ": No such file or directory");
  EXPECT_EQ(error_of(under_file), "cannot write " + under_file + ": Not a directory");
  EXPECT_EQ(error_of("/dev/full"), "cannot write /dev/full: not a regular file");
  std::filesystem::create_directory(folder / "d.vtu");
  EXPECT_EQ(error_of(folder / "d.vtu"), "cannot write " + (folder / "d.vtu") + ": Is a directory");
}

// While it lives, root, who may write everywhere, is nobody; anyone else is who they were.
class OrdinaryUser {
 public:
  OrdinaryUser() : user_(::geteuid()) { EXPECT_EQ(::seteuid(user_ == 0 ? 65534 : user_), 0); }
  ~OrdinaryUser() { EXPECT_EQ(::seteuid(user_), 0); }

 private:
  uid_t user_;
};

TEST(AtomicFile, RefusesAFolderAndAFileWithoutWritePermission) {
  const ScratchFolder folder;
  const std::string path = folder / "a.vtu", new_path = folder / "b.vtu";
  write_text(path, "old");
  ::chmod(path.c_str(), 0444);
  ::chmod((folder / "").c_str(), 0555);
  {
    const OrdinaryUser user;
    for (const std::string& refused : {path, new_path}) {
      EXPECT_EQ(input_error_of([&] { AtomicFile file(refused); }),
                "cannot write " + refused + ": Permission denied");
    }
  }
  ::chmod((folder / "").c_str(), 0755);
  EXPECT_EQ(folder.files(), Names{"a.vtu"});
}

class FullDisk : public testing::TestWithParam<std::string> {};

TEST_P(FullDisk, KeepsTheOldFilesAndLeavesNoNewOnes) {
  const ScratchFolder folder;
  const std::string path = folder / GetParam();
  const TetMesh mesh = make_test_mesh(8);
  const bool is_surface = path.ends_with(".stl") || path.ends_with(".ply");
  const auto write = [&] { is_surface ? write_surfaces(mesh, path) : write_mesh(mesh, path); };
  write();
  const Names names = folder.files();
  for (const std::string& name : names) write_text(folder / name, "old " + name);
  for (const rlim_t bytes : {0, 100, 6000}) {  // one file of several may still fit
    const FileSizeLimit limit(bytes);
    EXPECT_EQ(input_error_of(write).find("cannot write " + (folder / "")), 0u) << bytes;
    EXPECT_EQ(folder.files(), names) << bytes;
    for (const std::string& name : names) EXPECT_EQ(read_bytes(folder / name), "old " + name);
  }
  write();
  for (const std::string& name : names) EXPECT_NE(read_bytes(folder / name), "old " + name);
}

INSTANTIATE_TEST_SUITE_P(Formats, FullDisk, testing::Values("m.vtu", "m.mesh", "m.msh", "m.stl", "m.ply"),
                         [](const auto& instance) { return instance.param.substr(2); });

TEST(CheckPath, AcceptsWhatCanBeWrittenAndLeavesNoTrace) {
  const ScratchFolder folder;
  for (const char* name : {"a.vtu", "a.mesh", "a.msh"}) EXPECT_NO_THROW(check_mesh_path(folder / name));
  for (const char* name : {"a.stl", "a.ply"}) EXPECT_NO_THROW(check_surface_path(folder / name));
  EXPECT_EQ(folder.files(), Names{});
}

TEST(CheckPath, RefusesUnknownExtensionsAndUnwritablePlaces) {
  const ScratchFolder folder;
  for (const std::string name : {"a", "a.", "a.vtk", "a.stl", ".vtu", "none/a.vtu"}) {
    const std::string path = folder / name;
    EXPECT_NE(input_error_of([&] { check_mesh_path(path); }).find(path), std::string::npos) << name;
    EXPECT_THROW(write_mesh(make_test_mesh(2), path), InputError);
  }
  for (const std::string name : {"a", "a.vtu", "a.obj", "none/a.stl"}) {
    const std::string path = folder / name;
    EXPECT_NE(input_error_of([&] { check_surface_path(path); }).find(path), std::string::npos) << name;
    EXPECT_THROW(write_surfaces(make_test_mesh(2), path), InputError);
  }
  EXPECT_EQ(folder.files(), Names{});
}

}  // namespace
}  // namespace podm
