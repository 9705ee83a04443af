// Machines by description, by file and this machine: numbering, hops, round trips and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>

#include "runtime/placement.h"
#include "runtime/tests/machines.h"
#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

void expect_same(const Topology& a, const Topology& b) {
  ASSERT_EQ(a.num_nodes(), b.num_nodes());
  EXPECT_EQ(a.num_sockets(), b.num_sockets());
  EXPECT_EQ(a.num_cores(), b.num_cores());
  const auto same = [](const Processor& p, const Processor& q) {
    return p.os_index == q.os_index && p.core == q.core && p.node == q.node && p.socket == q.socket &&
           p.thread == q.thread;
  };
  EXPECT_TRUE(std::equal(a.processors().begin(), a.processors().end(), b.processors().begin(),
                         b.processors().end(), same));
  for (int i = 0; i < a.num_nodes(); ++i) {
    EXPECT_EQ(a.node_os_index(i), b.node_os_index(i));
    for (int j = 0; j < a.num_nodes(); ++j) EXPECT_EQ(a.hops(i, j), b.hops(i, j)) << i << ' ' << j;
  }
}

void expect_consistent(const Topology& machine) {
  std::set<int> os_indices, cores;
  ASSERT_FALSE(machine.processors().empty());
  for (const Processor& processor : machine.processors()) {
    EXPECT_TRUE(os_indices.insert(processor.os_index).second) << processor.os_index;
    cores.insert(processor.core);
    EXPECT_TRUE(processor.node >= 0 && processor.node < machine.num_nodes());
    EXPECT_TRUE(processor.socket >= 0 && processor.socket < machine.num_sockets());
  }
  EXPECT_EQ(static_cast<int>(cores.size()), machine.num_cores());
  int max_hops = 0;
  for (int a = 0; a < machine.num_nodes(); ++a)
    for (int b = 0; b < machine.num_nodes(); ++b) {
      EXPECT_EQ(machine.hops(a, b), machine.hops(b, a));
      EXPECT_EQ(machine.hops(a, b) == 0, a == b);
      max_hops = std::max(max_hops, machine.hops(a, b));
    }
  EXPECT_EQ(machine.max_hops(), max_hops);
}

// Returns the machine that is read from a file with the XML `text`.
Topology read_back(const std::string& text, const std::string& path) {
  std::ofstream(path) << text;
  return Topology::from_file(path);
}

TEST(Topology, OfOneNode) {
  const Topology machine = one_node();
  expect_consistent(machine);
  EXPECT_EQ(machine.processors().size(), 8u);
  EXPECT_EQ(machine.num_nodes(), 1);
  EXPECT_EQ(machine.num_sockets(), 1);
  EXPECT_EQ(machine.max_hops(), 0);
  EXPECT_FALSE(machine.is_this_machine());
}

TEST(Topology, OfTwoSocketsWithTwoNodesEach) {
  const Topology machine = two_sockets();
  expect_consistent(machine);
  EXPECT_EQ(machine.processors().size(), 32u);
  EXPECT_EQ(machine.num_cores(), 16);
  EXPECT_EQ(machine.num_nodes(), 4);
  EXPECT_EQ(machine.num_sockets(), 2);
  EXPECT_EQ(machine.max_hops(), 1) << "no matrix: every other node is one hop away";
  for (const Processor& processor : machine.processors()) {
    EXPECT_EQ(processor.socket, processor.node / 2);
    EXPECT_EQ(processor.node, processor.core / 4);
    EXPECT_LT(processor.thread, 2);
  }
}

TEST(Topology, HopsRankTheLatencies) {
  // A ring whose latencies grow with the square of the distance, and are slower in one direction.
  const auto ring = [](int a, int b) { return std::min((a - b + 16) % 16, (b - a + 16) % 16); };
  const auto latency = [&](int a, int b) {
    return 10 + 7 * ring(a, b) * ring(a, b) + (a < b && ring(a, b) > 0);
  };
  const Topology described = Topology::synthetic("numa:16 core:2 pu:1", latency_rows(16, latency));
  const Topology machine = read_back(described.to_xml(), ScratchFolder() / "ring.xml");
  expect_same(machine, described);
  expect_consistent(machine);
  EXPECT_EQ(machine.max_hops(), 8);
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < 16; ++b) EXPECT_EQ(machine.hops(a, b), ring(a, b));
}

TEST(Topology, HopsCountTheSlowerWay) {
  const Topology machine = Topology::synthetic("numa:3 pu:1", {10, 12, 20,  //
                                                               30, 10, 25,  //
                                                               20, 25, 10});
  EXPECT_EQ(machine.hops(0, 2), 1);
  EXPECT_EQ(machine.hops(1, 2), 2);
  EXPECT_EQ(machine.hops(0, 1), 3);
}

TEST(Topology, SurvivesAFile) {
  for (const Topology& machine : {one_node(), two_sockets(), four_nodes(), Topology::of_this_machine()}) {
    const Topology again = read_back(machine.to_xml(), ScratchFolder() / "machine.xml");
    expect_same(again, machine);
    EXPECT_FALSE(again.is_this_machine());
  }
}

TEST(Topology, OfThisMachineIsWhatThisProcessMayUse) {
  const Topology machine = Topology::of_this_machine();
  expect_consistent(machine);
  EXPECT_TRUE(machine.is_this_machine());
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  EXPECT_LE(static_cast<int>(machine.processors().size()), CPU_COUNT(&allowed));
  for (const Processor& processor : machine.processors())
    EXPECT_TRUE(CPU_ISSET(processor.os_index, &allowed)) << processor.os_index;
}

TEST(Topology, OfThisMachineHeedsTheAffinity) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own thread keeps the affinity of the process";
#endif
  const int os_index = Topology::of_this_machine().processors().back().os_index;
  const auto is_all = [](const Topology& machine, int processor) {
    return machine.processors().size() == 1 && machine.processors().front().os_index == processor;
  };
  EXPECT_EXIT(  // in a separate process, because its thread stays bound
      {
        pin_this_thread(os_index);
        std::exit(is_all(Topology::of_this_machine(), os_index) ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(Topology, OfThisMachineIsNeverAnother) {
  setenv("HWLOC_SYNTHETIC", "core:4 pu:1", 1);
  const std::string message = fault_of<TopologyError>([] { Topology::of_this_machine(); });
  unsetenv("HWLOC_SYNTHETIC");
  EXPECT_THAT(message, HasSubstr("HWLOC_SYNTHETIC"));
}

TEST(Topology, RefusesFilesThatDescribeNoMachine) {
  const ScratchFolder folder;
  const std::string path = folder / "machine.xml", whole = two_sockets().to_xml();
  for (const std::string& text :
       {std::string(), std::string("hello"), std::string("<?xml version=\"1.0\"?><a/>"),
        whole.substr(0, whole.size() / 2)})
    EXPECT_THAT(fault_of<TopologyError>([&] { read_back(text, path); }), StartsWith(path + ": ")) << text;
  for (const std::string type : {"PU", "NUMANode"}) {
    std::string unnumbered = whole;
    unnumbered.replace(unnumbered.find('"' + type + "\" os_index") + type.size() + 3, 2, "no");
    EXPECT_THAT(fault_of<TopologyError>([&] { read_back(unnumbered, path); }),
                StartsWith(path + ": " + type + " 0 has no os_index"));
  }
  EXPECT_THAT(fault_of<TopologyError>([] { Topology::from_file("/no/such/machine.xml"); }),
              HasSubstr("No such file"));
  EXPECT_THAT(fault_of<TopologyError>([] { Topology::from_file("/"); }), HasSubstr("the file is empty"));
}

TEST(Topology, RefusesDescriptionsThatMakeNoSense) {
  for (const char* description : {"", "pack:0", "two sockets", "core:2 core"})
    EXPECT_THAT(fault_of<TopologyError>([&] { Topology::synthetic(description); }), HasSubstr(description));
  EXPECT_THAT(fault_of<TopologyError>([] {
                Topology::synthetic("numa:2 core:1 pu:1", {10, 20});
              }),
              HasSubstr("2 nodes need 4"));
}

}  // namespace
}  // namespace podm::test
