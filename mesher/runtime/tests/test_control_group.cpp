// Limits of control groups, read from trees of /proc and /sys like those of real systems.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "runtime/control_group.h"

namespace podm::test {
namespace {

namespace fs = std::filesystem;

class Tree : public testing::Test {
 protected:
  Tree() {
    std::string name = (fs::temp_directory_path() / "podm-groups-XXXXXX").string();
    root_ = mkdtemp(name.data());
  }
  ~Tree() override { fs::remove_all(root_); }
  void write(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(root_ + path).parent_path());
    std::ofstream(root_ + path) << text << "\n";
  }
  // Writes a group of version 2 with its limit, its use, and the part of the use that is droppable files.
  void unified_group(const std::string& path, const std::string& most, int used, int droppable = 0) {
    write(path + "/memory.max", most);
    write(path + "/memory.current", std::to_string(used));
    write(path + "/memory.stat", "anon 5\ninactive_file " + std::to_string(droppable) + "\nactive_file 7");
  }
  std::uint64_t left() const { return memory_left_in_control_groups(root_); }
  std::string root_;
};

constexpr const char* kUnifiedMount =
    "30 24 0:26 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate";

TEST_F(Tree, NothingThereLimitsNothing) {
  EXPECT_EQ(left(), kNoLimit);
  EXPECT_TRUE(control_group_of("memory", root_).folders.empty());
}

TEST_F(Tree, NestedGroupsOfVersion2AllCount) {
  write("/proc/self/mountinfo", kUnifiedMount);
  write("/proc/self/cgroup", "0::/system.slice/slurm.scope/job 7/step");
  const std::string slice = "/sys/fs/cgroup/system.slice", job = slice + "/slurm.scope/job 7";
  unified_group(slice, "9000", 100);
  unified_group(job, "5000", 1500, 500);
  unified_group(job + "/step", "max", 300);
  EXPECT_EQ(left(), 4000u) << "of the job, which can drop 500 of its 1500";
  unified_group(job + "/step", "400", 300);
  EXPECT_EQ(left(), 100u);
  unified_group(slice, "50", 100);
  EXPECT_EQ(left(), 0u) << "it is over its limit already";
  const ControlGroup group = control_group_of("cpu", root_);
  EXPECT_TRUE(group.is_unified);
  EXPECT_EQ(group.folders.front(), root_ + job + "/step");
}

// The container sees its group's own folder as the mount.
TEST_F(Tree, ContainersSeeTheirGroupAsTheRoot) {
  write("/proc/self/mountinfo", "40 30 0:26 /docker/17 /sys/fs/cgroup ro - cgroup2 cgroup rw");
  write("/proc/self/cgroup", "0::/docker/17");
  unified_group("/sys/fs/cgroup", "3000", 1000);
  EXPECT_EQ(left(), 2000u);
  write("/proc/self/cgroup", "0::/");
  EXPECT_EQ(left(), 2000u) << "with a namespace of groups";
  write("/proc/self/cgroup", "0::/../../elsewhere");
  EXPECT_EQ(left(), 2000u) << "outside of the namespace";
}

// For example, a container's group that is mounted for monitoring.
TEST_F(Tree, MountsOfOtherGroupsAreNotOurs) {
  const std::string own = "30 24 0:26 / /sys/fs/cgroup rw - cgroup2 cgroup2 rw";
  const std::string others =
      "29 24 0:26 /other /mnt/other rw - cgroup2 cgroup2 rw\n"
      "28 24 0:26 /batch/jo /mnt/jo rw - cgroup2 cgroup2 rw\n"
      "27 24 0:26 /batch/job /mnt/job rw - cgroup2 cgroup2 rw";
  write("/proc/self/cgroup", "0::/batch/job");
  for (const char* folder : {"/mnt/other", "/mnt/jo"}) unified_group(folder, "max", 0);
  unified_group("/sys/fs/cgroup/batch", "4000", 1000);
  unified_group("/sys/fs/cgroup/batch/job", "9000", 1000);
  unified_group("/mnt/job", "9000", 1000);
  for (const std::string& mounts : {others + "\n" + own, own + "\n" + others}) {
    write("/proc/self/mountinfo", mounts);
    EXPECT_EQ(left(), 3000u) << "of the group around ours, which one mount alone shows\n" << mounts;
  }
  write("/proc/self/mountinfo", others);
  EXPECT_EQ(left(), 8000u) << "of ours, all there is to see";
}

TEST_F(Tree, WhatTheKernelHoldsUpAboveIsALimit) {
  write("/proc/self/mountinfo", kUnifiedMount);
  write("/proc/self/cgroup", "0::/outer/inner");
  const std::string outer = "/sys/fs/cgroup/outer", inner = outer + "/inner";
  unified_group(outer, "5000", 1000);
  unified_group(inner, "max", 1000);
  EXPECT_EQ(left(), 4000u);
  EXPECT_EQ(memory_limit_of_control_groups(root_), 5000u);
  write(inner + "/memory.high", "3500");
  EXPECT_EQ(left(), 2500u);
  EXPECT_EQ(memory_limit_of_control_groups(root_), 3500u);
  write(inner + "/memory.high", "max");
  EXPECT_EQ(left(), 4000u);
}

TEST_F(Tree, Version1HasAHierarchyAController) {
  write("/proc/self/mountinfo",
        "33 31 0:30 / /sys/fs/cgroup/cpu,cpuacct rw - cgroup cgroup rw,cpu,cpuacct\n"
        "35 31 0:32 / /sys/fs/cgroup/my\\040memory rw - cgroup cgroup rw,memory\n"
        "36 31 0:33 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw");
  write("/proc/self/cgroup", "4:memory:/batch/job\n3:cpu,cpuacct:/batch\n0::/init.scope");
  const std::string memory = "/sys/fs/cgroup/my memory", job = memory + "/batch/job";
  write(memory + "/memory.limit_in_bytes", "9223372036854771712");
  write(memory + "/memory.usage_in_bytes", "100");
  write(job + "/memory.limit_in_bytes", "7000");
  write(job + "/memory.usage_in_bytes", "3000");
  write(job + "/memory.stat", "inactive_file 1\ntotal_inactive_file 1000");
  EXPECT_EQ(left(), 5000u);
  EXPECT_EQ(memory_limit_of_control_groups(root_), 7000u);
  write(job + "/memory.limit_in_bytes", "9223372036854771712");
  EXPECT_EQ(memory_limit_of_control_groups(root_), kNoLimit);
  EXPECT_FALSE(control_group_of("memory", root_).is_unified);
  EXPECT_EQ(control_group_of("cpu", root_).folders.back(), root_ + "/sys/fs/cgroup/cpu,cpuacct");
}

TEST_F(Tree, OfThisProcessAreReadable) {
  for (const std::string& folder : control_group_of("memory").folders)
    EXPECT_TRUE(fs::is_directory(folder)) << folder;
  EXPECT_GT(memory_left_in_control_groups(), std::uint64_t{1} << 20) << "or this test could not run";
}

}  // namespace
}  // namespace podm::test
