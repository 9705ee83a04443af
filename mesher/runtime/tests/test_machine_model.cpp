// Machines described in TOML: every file of experiments/machines, properties of networks, and refusals.
#include "runtime/machine_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kMachines = PODM_MACHINES;

const std::string kOneNode = R"(name = "one"
[processor]
sockets_per_node = 2
cores_per_socket = 4
clock_ghz = 2.0
core_speed = 0.5
caches = [{level = 1, kib = 32, cores = 1, cycles = 4}, {level = 3, kib = 8192, cores = 4, cycles = 40}]
[memory]
gib_per_node = 1
local_cycles = 200
cycles_per_hop = 1000
miss_share = 0.25
[system]
wake_us = 5
lock_us = 0.5
)";

// Four nodes in a ring.
const std::string kRing = kOneNode + R"([network]
nodes = 4
links = [["node 0", "node 1"], ["node 1", "node 2"], ["node 2", "node 3"], ["node 3", "node 0"]]
hub_accesses_per_s = 4e6
)";

MachineModel model_of(const std::string& text) {
  const ScratchFolder folder;
  return MachineModel::from_file(folder.write("machine.toml", text));
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t place = text.find(old);
  EXPECT_NE(place, std::string::npos) << old;
  return text.replace(place, old.size(), by);
}

// Returns the number of paths through each station, without the paths that end there.
std::vector<int> paths_through(const MachineModel& model) {
  std::vector<int> paths(model.stations.size());
  for (const std::vector<int>& route : model.routes)
    for (std::size_t i = 1; i + 1 < route.size(); ++i) ++paths[route[i]];
  return paths;
}

void expect_consistent(const MachineModel& model) {
  EXPECT_EQ(model.routes.size(), static_cast<std::size_t>(model.num_nodes()) * model.num_nodes());
  EXPECT_GE(model.stations.size(), static_cast<std::size_t>(model.num_nodes()));
  EXPECT_GT(model.local_latency_s, model.caches.back().latency_s);
  for (int a = 0; a < model.num_nodes(); ++a) {
    EXPECT_EQ(model.stations[a].name, "node " + std::to_string(a));
    EXPECT_TRUE(model.route(a, a).empty());
    EXPECT_EQ(model.latency_s(a, a), model.local_latency_s);
    for (int b = 0; b < model.num_nodes(); ++b) {
      EXPECT_EQ(model.num_links(a, b), model.num_links(b, a));
      if (a == b) continue;
      EXPECT_EQ(model.route(a, b).front(), a);
      EXPECT_EQ(model.route(a, b).back(), b);
      for (int c = 0; c < model.num_nodes(); ++c)
        EXPECT_EQ(model.latency_s(a, b) < model.latency_s(a, c),
                  model.topology.hops(a, b) < model.topology.hops(a, c));
    }
  }
}

TEST(MachineModel, EveryDescriptionIsRead) {
  int num_read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kMachines)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    ++num_read;
    const MachineModel model = MachineModel::from_file(entry.path());
    expect_consistent(model);
    EXPECT_FALSE(model.sources.empty());
    EXPECT_EQ(model.caches.front().level, 1);
    EXPECT_LT(model.lock_s, model.wake_s);
  }
  EXPECT_GE(num_read, 4);
}

TEST(MachineModel, OfBlacklightIsAsDocumented) {
  const MachineModel model = MachineModel::from_file(kMachines + "/blacklight.toml");
  EXPECT_EQ(model.topology.num_cores(), 256);
  EXPECT_EQ(model.num_nodes(), 16);
  EXPECT_EQ(model.topology.num_sockets(), 32);
  for (int blade = 0; blade < 16; ++blade) {
    std::vector<int> blades_at(4);
    for (int other = 0; other < 16; ++other) {
      const int links = model.num_links(blade, other);
      ++blades_at.at(links);
      EXPECT_EQ(model.topology.hops(blade, other), links);
      EXPECT_NEAR(model.latency_s(blade, other) * 2.27e9, 200 + 1500 * links, 1e-6);
    }
    EXPECT_THAT(blades_at, ElementsAre(1, 1, 7, 7));
  }
  EXPECT_THAT(model.route(4, 5), ElementsAre(4, 5));
  EXPECT_THAT(model.route(4, 8), ElementsAre(4, 16, 8));
  EXPECT_EQ(model.stations[16].name, "router 0");
}

TEST(MachineModel, EqualWaysShareTheLoad) {
  const std::vector<int> paths = paths_through(MachineModel::from_file(kMachines + "/blacklight.toml"));
  EXPECT_EQ(paths[16], paths[17]) << "routers";
  EXPECT_EQ(std::set<int>(paths.begin(), paths.begin() + 16).size(), 1u)
      << "hubs of 16 blades that are alike";
  const std::vector<int> around = paths_through(model_of(kRing));
  EXPECT_EQ(std::accumulate(around.begin(), around.end(), 0), 4) << "each node to the opposite one";
  EXPECT_EQ(*std::max_element(around.begin(), around.end()), 1);
}

TEST(MachineModel, CoresSlowEachOtherDown) {
  const MachineModel alone = model_of(kOneNode),
                     model = model_of(
                         replaced(kOneNode, "core_speed = 0.5", "core_speed = 0.5\nspeed_when_full = 0.8"));
  EXPECT_DOUBLE_EQ(alone.speed_of_one_of(8), 0.5);
  EXPECT_DOUBLE_EQ(model.speed_of_one_of(1), 0.5);
  EXPECT_DOUBLE_EQ(model.speed_of_one_of(8), 0.4);
  EXPECT_DOUBLE_EQ(model.speed_of_one_of(100), 0.4) << "more workers than cores";
}

TEST(MachineModel, UnitsBecomeSeconds) {
  const MachineModel model = model_of(kRing);
  expect_consistent(model);
  EXPECT_EQ(model.name, "one");
  EXPECT_EQ(model.core_speed, 0.5);
  EXPECT_EQ(model.miss_share, 0.25);
  EXPECT_NEAR(model.caches.back().latency_s, 20e-9, 1e-15);
  EXPECT_NEAR(model.local_latency_s, 100e-9, 1e-15);
  EXPECT_NEAR(model.latency_s(0, 2), 1100e-9, 1e-15);
  EXPECT_NEAR(model.stations.front().service_s, 250e-9, 1e-15);
  EXPECT_NEAR(model.wake_s, 5e-6, 1e-15);
  EXPECT_NEAR(model.lock_s, 0.5e-6, 1e-15);
  EXPECT_EQ(model.retries, 0);
  EXPECT_EQ(model.line_transfer_s, 0);
  EXPECT_EQ(model.page_fault_s, 0);
}

TEST(MachineModel, MayHaveCostsOfSharedLinesAndNewPages) {
  const MachineModel model = model_of(
      replaced(kRing, "lock_us = 0.5", "lock_us = 0.5\nline_transfer_ns = 80\npage_fault_us = 0.25"));
  EXPECT_NEAR(model.line_transfer_s, 80e-9, 1e-18);
  EXPECT_NEAR(model.page_fault_s, 0.25e-6, 1e-18);
}

TEST(MachineModel, OfOneNodeNeedsNoNetwork) {
  const MachineModel model = model_of(replaced(kOneNode, "cycles_per_hop = 1000\nmiss_share = 0.25\n", ""));
  expect_consistent(model);
  EXPECT_EQ(model.topology.num_cores(), 8);
  EXPECT_EQ(model.topology.num_sockets(), 2);
  EXPECT_EQ(model.stations.size(), 1u);
  EXPECT_EQ(model.stations.front().service_s, 0) << "no limit";
}

// A text of the ring, its replacement, the place of the fault and a word of the message.
struct Fault {
  std::string old, by, place, word;
};

class RefusedMachines : public testing::TestWithParam<Fault> {};

TEST_P(RefusedMachines, AreRefusedWithTheirPlace) {
  const auto& [old, by, place, word] = GetParam();
  const ScratchFolder folder;
  const std::string path = folder.write("machine.toml", replaced(kRing, old, by));
  EXPECT_THAT(fault_of<TopologyError>([&] { MachineModel::from_file(path); }),
              AllOf(StartsWith(path + ":" + place + ":"), HasSubstr(word)));
}

INSTANTIATE_TEST_SUITE_P(
    MachineModel, RefusedMachines,
    testing::Values(
        Fault{"name = \"one\"", "name = 1", "1", "name must be a non-empty string"},
        Fault{"name = \"one\"", "colour = 'red'\nname = 'a'", "1", "no key 'colour'"},
        Fault{"name = \"one\"", "name = 'a", "1", ""},
        Fault{"core_speed", "cor\xC3\xA9_speed", "6:4", "ASCII"},
        Fault{"sockets_per_node = 2\n", "", "2", "needs the key 'sockets_per_node'"},
        Fault{"sockets_per_node = 2", "sockets_per_node = 2.0", "3", "must be an integer"},
        Fault{"cores_per_socket = 4", "cores_per_socket = 0", "4", "from 1 to"},
        Fault{"cores_per_socket = 4", "cores_per_socket = 99999", "4", "from 1 to"},
        Fault{"clock_ghz = 2.0", "clock_ghz = nan", "5", "must be a number"},
        Fault{"clock_ghz = 2.0", "clock_ghz = inf", "5", "must be a number"},
        Fault{"clock_ghz = 2.0", "clock_mhz = 2000", "2", "needs the key 'clock_ghz'"},
        Fault{"core_speed = 0.5", "core_speed = -1", "6", "must be a number from"},
        Fault{"level = 3", "level = 1", "7", "from the fastest to the slowest"},
        Fault{"cycles = 40", "cycles = 3", "7", "from the fastest to the slowest"},
        Fault{"cores = 4,", "cores = 9,", "7", "from 1 to 8"},
        Fault{"gib_per_node = 1", "gib_per_node = 0", "9", "gib_per_node"},
        Fault{"local_cycles = 200", "local_cycles = 30", "10", "slower than any cache"},
        Fault{"cycles_per_hop = 1000\n", "", "8", "needs the key 'cycles_per_hop'"},
        Fault{"miss_share = 0.25", "miss_share = 1.5", "12", "from 0 to 1"},
        Fault{"wake_us = 5", "wake_us = \"5\"", "14", "wake_us must be a number"},
        Fault{"lock_us = 0.5", "lock_us = 0.5\nline_transfer_ns = -1", "16", "line_transfer_ns must be"},
        Fault{"lock_us = 0.5", "lock_us = 0.5\npage_fault_us = nan", "16", "page_fault_us must be"},
        Fault{"nodes = 4", "nodes = 400", "17", "from 1 to 256"},
        Fault{"nodes = 4", "nodes = 5", "16", "node 4 is not connected to node 0"},
        Fault{"nodes = 4", "nodes = 4\nrouters = 1", "16", "router 0 is not connected to node 0"},
        Fault{"\"node 3\", \"node 0\"", "\"node 4\", \"node 0\"", "18", "\"node 4\" is none"},
        Fault{"\"node 3\", \"node 0\"", "\"router 0\", \"node 0\"", "18", "0 routers"},
        Fault{"\"node 3\", \"node 0\"", "\"node\", \"node 0\"", "18", "\"node\" is none"},
        Fault{"\"node 3\", \"node 0\"", "\"node 3x\", \"node 0\"", "18", "\"node 3x\" is none"},
        Fault{"\"node 3\", \"node 0\"", "\"node 3\"", "18", "a link is a pair"},
        Fault{"\"node 3\", \"node 0\"", "\"node 3\", 0", "18", "must be a non-empty string"},
        Fault{"\"node 3\", \"node 0\"", "\"node 3\", \"node 3\"", "18", "to itself"},
        Fault{"\"node 3\", \"node 0\"", "\"node 1\", \"node 0\"", "18", "second link"},
        Fault{"hub_accesses_per_s = 4e6", "hub_accesses_per_s = 0", "19", "must be a number from"}));

TEST(MachineModel, RefusesMoreCoresThanAnyMachineHas) {
  const std::string text = replaced(replaced(kRing, "sockets_per_node = 2", "sockets_per_node = 64"),
                                    "cores_per_socket = 4", "cores_per_socket = 1024");
  EXPECT_THAT(fault_of<TopologyError>([&] { model_of(text); }), HasSubstr("more than 16384 cores"));
}

TEST(MachineModel, RefusesFilesThatAreNotThere) {
  EXPECT_THAT(fault_of<TopologyError>([] { MachineModel::from_file("/no/such/machine.toml"); }),
              StartsWith("/no/such/machine.toml: "));
}

}  // namespace
}  // namespace podm::test
