#include <gtest/gtest.h>

#include <set>

#include "experiments/experiment.h"
#include "machine/machine.h"
#include "process/usable_processors.h"
#include "tests/fake_mesher.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::string kHead = R"(title = "T"
claim = "C"
[inputs.a]
image = "phantom:torus"
)";

const std::string kTrial = R"([[trials]]
name = "one"
input = "a"
)";

class ExperimentTest : public testing::Test {
 protected:
  Experiment read(const std::string& text) {
    const bool has_claims = text.find("[[claims]]") != std::string::npos;
    return read_experiment(folder_.write("some.toml", has_claims ? text : text + kClaim));
  }
  // Returns the fault that read_experiment() reports for the text, without the folder.
  std::string fault(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(folder_.path())) << what;
      return what.substr(folder_.path().size() + 1);
    }
    return "none";
  }
  TemporaryFolder folder_;
};

TEST_F(ExperimentTest, EveryKeyIsRead) {
  const Experiment experiment = read(R"(
title = "Title"
claim = "Claim"
paper = "Table 1"
tier = "full"
expected_minutes = 1.5
timeout_s = 7
memory_limit_gib = 2
repeats = 3
warmup = 1
[inputs.file]
image = "data/head.nii"
if_exists = true
[inputs.phantom]
image = "phantom:torus@64"
[[trials]]
name = "first"
input = "phantom"
radius_mm = 2
delta_mm = 0.5
threads = 4
timeout_s = 9
memory_limit_gib = 0.5
repeats = 5
warmup = 0
tier = "kick-tires"
[[trials]]
name = "second"
input = "file"
target_elements = 1_000
)");
  EXPECT_EQ(experiment.name, "some");
  EXPECT_EQ(experiment.title, "Title");
  EXPECT_EQ(experiment.claim, "Claim");
  EXPECT_EQ(experiment.paper, "Table 1");
  ASSERT_EQ(experiment.claims.size(), 1u);
  EXPECT_EQ(experiment.claims[0].name, "all-pass");
  EXPECT_EQ(experiment.tier, Tier::kFull);
  EXPECT_EQ(experiment.expected_minutes, 1.5);
  ASSERT_EQ(experiment.trials.size(), 2u);
  const Trial& first = experiment.trials[0];
  EXPECT_EQ(first.name, "first");
  EXPECT_EQ(first.image, "phantom:torus@64");
  EXPECT_FALSE(first.if_exists);
  EXPECT_EQ(first.options, Json({{"threads", 4}, {"radius_mm", 2.0}, {"delta_mm", 0.5}}));
  EXPECT_EQ(first.timeout_s, 9);
  EXPECT_EQ(first.memory_limit_gib, 0.5);
  EXPECT_EQ(first.repeats, 5);
  EXPECT_EQ(first.warmups, 0);
  EXPECT_EQ(first.tier, Tier::kKickTires);
  const Trial& second = experiment.trials[1];
  EXPECT_EQ(second.image, folder_ / "data/head.nii");  // beside the experiment
  EXPECT_TRUE(second.if_exists);
  EXPECT_EQ(second.options, Json({{"threads", 1}, {"target_elements", 1000}}));
  EXPECT_EQ(second.timeout_s, 7);  // of the experiment, as the following ones
  EXPECT_EQ(second.memory_limit_gib, 2);
  EXPECT_EQ(second.repeats, 3);
  EXPECT_EQ(second.warmups, 1);
  EXPECT_EQ(second.tier, Tier::kFull);
  EXPECT_EQ(experiment.num_turns(), 5u + 4u);
}

TEST_F(ExperimentTest, AbsoluteImagePathsStayAsTheyAre) {
  EXPECT_EQ(read("title='T'\nclaim='C'\n[inputs.a]\nimage='/data/x.nii'\n" + kTrial).trials[0].image,
            "/data/x.nii");
}

TEST_F(ExperimentTest, FaultsNameFileLineAndColumn) {
  struct Case {
    std::string text, place, word;
  };
  const Case cases[] = {
      {"title = \"T\"\nclaim = = 1\n", "some.toml:2:", ""},                     // not TOML
      {"colour = 1\n" + kHead + kTrial, "some.toml:1:1:", "colour"},            // unknown keys, in any place
      {kHead + "spacing = 1\n" + kTrial, "some.toml:5:1:", "spacing"},          //
      {kHead + kTrial + "radios_mm = 1\n", "some.toml:8:1:", "radios_mm"},      //
      {"title = 3\nclaim = 'C'\n", "some.toml:1:9:", "title"},                  // wrong types
      {kHead + "if_exists = 1\n" + kTrial, "some.toml:5:13:", "if_exists"},     //
      {kHead + kTrial + "radius_mm = 'x'\n", "some.toml:8:13:", "radius_mm"},   //
      {kHead + kTrial + "radius_mm = true\n", "some.toml:8:13:", "radius_mm"},  //
      {kHead + kTrial + "threads = 1.5\n", "some.toml:8:11:", "threads"},       //
      {"title='T'\nclaim='C'\ninputs = 3\n" + kTrial, "some.toml:3:10:", "inputs"},
      {"title='T'\nclaim='C'\n[inputs]\na = 3\n" + kTrial, "some.toml:4:5:", "inputs.a"},
      {kHead + "[trials]\nname='x'\n", "some.toml:5:", "trials"},
      {kHead + kTrial + "radius_mm = 0\n", "some.toml:8:13:", "radius_mm"},  // out of range
      {kHead + kTrial + "radius_mm = nan\n", "some.toml:8:13:", "radius_mm"},
      {kHead + kTrial + "radius_mm = inf\n", "some.toml:8:13:", "radius_mm"},
      {kHead + kTrial + "delta_mm = -1\n", "some.toml:8:12:", "delta_mm"},
      {kHead + kTrial + "min_dihedral = -8\n", "some.toml:8:16:", "min_dihedral"},
      {kHead + kTrial + "optimize = 8\n", "some.toml:8:12:", "optimize"},
      {kHead + kTrial + "mesher = 'cgal'\noptimize = true\n", "some.toml:9:12:", "podm only"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'mpi'\nsolve = true\n", "some.toml:10:9:", "exclude"},
      {kHead + kTrial + "threads = 0\n", "some.toml:8:11:", "threads"},
      {kHead + kTrial + "target_elements = -5\n", "some.toml:8:19:", "target_elements"},
      {kHead + "[[trials]]\nname = '../x'\ninput = 'a'\n", "some.toml:6:8:", "name"},  // would be a path
      {kHead + "[[trials]]\nname = ''\ninput = 'a'\n", "some.toml:6:8:", "name"},
      {kHead + "[[trials]]\nname = 'x'\ninput = 'b'\n", "some.toml:7:9:", "inputs.b"},  // contradictions
      {kHead + kTrial + kTrial, "some.toml:9:8:", "one"},
      {kHead + kTrial + "radius_mm = 1\ntarget_elements = 5\n", "some.toml:9:19:", "exclude"},
      {kHead + kTrial + "target_elements = 1\ntarget_elements_per_thread = 5\n",
       "some.toml:9:30:", "exclude"},
      {kHead + kTrial + "threads = 4\ntarget_elements_per_thread = 2000000000\n",
       "some.toml:9:30:", "8000000000"},
      {kHead + kTrial + "threads = [1, 0]\n", "some.toml:8:15:", "threads"},  // in arrays
      {kHead + kTrial + "threads = []\n", "some.toml:8:11:", "threads"},
      {kHead + kTrial + "threads = 'most'\n", "some.toml:8:11:", "1..all"},
      {kHead + kTrial + "contention = ['local', 3]\n", "some.toml:8:24:", "contention"},
      {kHead + kTrial + "seed = -1\n", "some.toml:8:8:", "seed"},
      {kHead + kTrial + "pin = 1.5\n", "some.toml:8:7:", "pin"},
      {kHead + kTrial + "repeats = 0\n", "some.toml:8:11:", "repeats"},
      {kHead + kTrial + "repeats = [1, 2]\n", "some.toml:8:11:", "repeats"},
      {kHead + kTrial + "memory_limit_gib = 0\n", "some.toml:8:20:", "memory_limit_gib"},
      {kHead + kTrial + "counters = 'likwid:'\n", "some.toml:8:12:", "likwid:GROUP"},
      {kHead + kTrial + "counters = 'likwid:a/b'\n", "some.toml:8:12:", "likwid:GROUP"},
      {kHead + kTrial + "counters = ['perf_event', 'perf']\n", "some.toml:8:27:", "cachegrind"},
      {kHead + "[[trials]]\nname = 'x'\nmeasure = 'weight'\n", "some.toml:7:11:", "memory_latency"},
      {kHead + "[[trials]]\nname = 'x'\nmeasure = 'memory_latency'\ninput = 'a'\n",
       "some.toml:8:9:", "input"},
      {kHead + "[[trials]]\nname = 'x'\nmeasure = 'memory_latency'\nthreads = 2\n",
       "some.toml:8:11:", "threads"},
      {kHead + kTrial + "ranks = 2\n", "some.toml:8:9:", "carrier"},
      {kHead + kTrial + "carrier = 'mpi'\n", "some.toml:8:11:", "ranks"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'pigeon'\n", "some.toml:9:11:", "in-process"},
      {kHead + kTrial + "target_elements_per_rank = 5\n", "some.toml:8:28:", "ranks"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'mpi'\nnetwork = '2,12.5'\n", "some.toml:10:11:", "in-process"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'in-process'\nnetwork = '2'\n", "some.toml:10:11:", "12.5"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'in-process'\nnetwork = '2,0'\n", "some.toml:10:11:", "12.5"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'mpi'\nexecutor = 'virtual'\n",
       "some.toml:10:12:", "in-process"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'mpi'\nreplay = true\n", "some.toml:10:10:", "exclude"},
      {kHead + kTrial + "ranks = 2\ncarrier = 'mpi'\nmesher = 'cgal'\n", "some.toml:8:9:", "podm only"},
      {"tier = 'huge'\n" + kHead + kTrial, "some.toml:1:8:", "kick-tires"},
      {kHead + "[[trials]]\nname = 'x'\ninput = ['a', 'b']\n", "some.toml:7:15:", "inputs.b"},
      {kHead, "some.toml:1:", "trials"},  // absent keys
      {kHead + "[[trials]]\ninput = 'a'\n", "some.toml:5:", "name"},
      {"claim='C'\n" + kTrial, "some.toml:1:", "title"},
      {"", "some.toml:", "title"},
  };
  for (const auto& [text, place, word] : cases) {
    const std::string message = fault(text);
    EXPECT_TRUE(message.starts_with(place)) << message << "\nfor\n" << text;
    EXPECT_NE(message.find(word), std::string::npos) << message << "\nfor\n" << text;
  }
}

TEST_F(ExperimentTest, ArraysBecomeTheirProduct) {
  const auto trials =
      read(kHead + kTrial + "threads = [1, 4]\ncontention = ['local', 'global']\nradius_mm = [2.5]\n").trials;
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_EQ(trials[0].name, "one,radius_mm=2.5,threads=1,contention=local");
  EXPECT_EQ(trials[3].name, "one,radius_mm=2.5,threads=4,contention=global");
  std::set<std::pair<int, std::string>> settings;
  for (const Trial& trial : trials) settings.emplace(trial.options["threads"], trial.options["contention"]);
  EXPECT_EQ(settings.size(), 4u);
}

TEST_F(ExperimentTest, ThreadsUpToAllArePowersOfTwoAndAll) {
  const int all = usable_processors();
  const auto threads_of = [&](const std::string& value) {
    std::vector<int> threads;
    for (const Trial& trial : read(kHead + kTrial + "threads = " + value + "\n").trials)
      threads.push_back(trial.options["threads"]);
    return threads;
  };
  EXPECT_EQ(threads_of("'all'"), std::vector<int>{all});
  const auto powers = threads_of("'1..all'");
  EXPECT_EQ(powers.front(), 1);
  EXPECT_EQ(powers.back(), all);
  for (std::size_t i = 1; i < powers.size(); ++i) {
    EXPECT_GT(powers[i], powers[i - 1]);
    if (i + 1 < powers.size()) {
      EXPECT_EQ(powers[i], 2 * powers[i - 1]);
    }
  }
  EXPECT_EQ(threads_of("['1..all', 'all', 1]"), powers) << "each number once";
}

TEST_F(ExperimentTest, ElementsPerRankGrowWithTheRanks) {
  const auto trials =
      read(kHead + kTrial + "ranks = [1, 64]\ncarrier = 'in-process'\ntarget_elements_per_rank = 1000\n")
          .trials;
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[1].name, "one,ranks=64");
  EXPECT_EQ(trials[1].options["target_elements"], 64000);
  EXPECT_FALSE(trials[1].options.contains("target_elements_per_rank"));
}

TEST_F(ExperimentTest, ElementsPerThreadGrowWithTheThreads) {
  const auto trials = read(kHead + kTrial + "threads = [1, 3]\ntarget_elements_per_thread = 1000\n").trials;
  ASSERT_EQ(trials.size(), 2u);
  for (const Trial& trial : trials) {
    EXPECT_EQ(trial.options["target_elements"], 1000 * trial.options["threads"].get<int>());
    EXPECT_FALSE(trial.options.contains("target_elements_per_thread"));
  }
}

TEST_F(ExperimentTest, MeasurementOfTheMachineNeedsNoInput) {
  const std::string path = folder_.write(
      "some.toml", "title = 'T'\nclaim = 'C'\n[[trials]]\nname = 'x'\nmeasure = 'memory_latency'\n" + kClaim);
  for (const std::vector<std::string>& images :
       {std::vector<std::string>{}, {"mine.nii"}, {"mine.nii", "yours.nii"}}) {
    const auto trials = read_experiment(path, images).trials;
    ASSERT_EQ(trials.size(), 1u);
    EXPECT_EQ(trials[0].name, "x");
    EXPECT_FALSE(makes_mesh(trials[0]));
  }
}

TEST_F(ExperimentTest, ImagesStandForAllInputs) {
  const std::string path = folder_.write(
      "some.toml", kHead + "[inputs.b]\nimage = 'b.nii'\nif_exists = true\n" +
                       "[[trials]]\nname = 'x'\ninput = ['a', 'b']\nthreads = [1, 2]\n" + kClaim);
  EXPECT_EQ(read_experiment(path).trials.size(), 4u);
  const auto trials = read_experiment(path, {"mine.nii"}).trials;
  ASSERT_EQ(trials.size(), 2u);
  for (const Trial& trial : trials) {
    EXPECT_EQ(trial.image, "mine.nii");
    EXPECT_FALSE(trial.if_exists);
    EXPECT_EQ(trial.name.find("input"), std::string::npos);
  }
  const auto of_two = read_experiment(path, {"folder/mine.nii", "phantom:torus@64"}).trials;
  ASSERT_EQ(of_two.size(), 4u);
  EXPECT_EQ(of_two[0].name, "x,input=mine.nii,threads=1");
  EXPECT_EQ(of_two[0].image, "folder/mine.nii");
  EXPECT_EQ(of_two[3].name, "x,input=phantom_torus_64,threads=2");
}

TEST_F(ExperimentTest, ImageGrowsWithTheThreads) {
  const std::string text = "title='T'\nclaim='C'\n[inputs.a]\nimage='phantom:torus@100'\n" + kTrial +
                           "threads = [1, 8]\ntarget_elements_per_thread = 1000\nimage_grows = true\n" +
                           kClaim;
  const auto trials = read(text).trials;
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0].image, "phantom:torus@100");
  EXPECT_EQ(trials[1].image, "phantom:torus@200") << "as many voxels a thread";
  const std::string path = folder_.write("some.toml", text);
  EXPECT_EQ(read_experiment(path, {"mine.nii"}).trials[1].image, "mine.nii") << "it is skipped when run";
  EXPECT_EQ(read_experiment(path, {"phantom:spheres@50"}).trials[1].image, "phantom:spheres@100");
  EXPECT_NE(fault(kHead + kTrial + "image_grows = true\n").find(":8:15: image_grows needs a phantom"),
            std::string::npos);
}

TEST_F(ExperimentTest, ALengthIsInVoxelsOrInMillimetres) {
  EXPECT_NE(fault(kHead + kTrial + "smooth = 2\nsmooth_voxels = 2\n").find("exclude each other"),
            std::string::npos);
  EXPECT_NE(fault(kHead + kTrial + "target_elements = 9\ndelta_voxels = 2\n").find("exclude each other"),
            std::string::npos);
}

TEST_F(ExperimentTest, CopiesAreOfOneThread) {
  const auto trials = read(kHead + kTrial + "copies = [1, 'all']\n").trials;
  EXPECT_EQ(trials.front().name, "one,copies=1");
  EXPECT_EQ(trials.back().options["copies"], usable_processors());
  EXPECT_NE(fault(kHead + kTrial + "copies = 2\nthreads = 2\n").find("copies need threads = 1"),
            std::string::npos);
  EXPECT_NE(fault(kHead + kTrial + "copies = 2\npin = 'compact'\n").find("exclude"), std::string::npos);
}

TEST_F(ExperimentTest, TopologiesAreBesideTheExperimentAndOptionsKeepTheirTypes) {
  const Json options = read(kHead + kTrial + R"(
topology = "machines/big.xml"
pin = true
oversubscribe = false
executor = "virtual"
initial_ratio = 4
nodes = 2
seed = 0
)")
                           .trials[0]
                           .options;
  EXPECT_EQ(options["topology"], folder_ / "machines/big.xml");
  EXPECT_EQ(options["pin"], true);
  EXPECT_EQ(options["oversubscribe"], false);
  EXPECT_EQ(options["executor"], "virtual");
  EXPECT_EQ(options["initial_ratio"], 4.0);
  EXPECT_EQ(options["nodes"], 2);
  EXPECT_EQ(options["seed"], 0);
}

TEST_F(ExperimentTest, OtherMeshersTakeRadiusDeltaAndThreadsAlone) {
  const std::string peer = kHead + kTrial + "mesher = [\"podm\", \"other\"]\nradius_mm = 2\n";
  EXPECT_EQ(read(peer + "delta_mm = 1\nthreads = 2\n").trials.size(), 2u);
  const std::string what = fault(peer + "pin = true\n");
  EXPECT_NE(what.find("pin is an option of podm only"), std::string::npos) << what;
}

// The experiments in experiments/ are complete, and each has trials in the tiers kick-tires and default.
TEST(Experiments, StateClaimsAndTimeAndHaveAKickTiresTier) {
  for (const std::string& path : experiment_files(PODM_EXPERIMENTS)) {
    const Experiment experiment = read_experiment(path);
    EXPECT_FALSE(experiment.claims.empty()) << path;
    EXPECT_GT(experiment.expected_minutes, 0) << path;
    std::set<Tier> tiers;
    for (const Trial& trial : experiment.trials) tiers.insert(trial.tier);
    EXPECT_TRUE(tiers.contains(Tier::kKickTires)) << path;
    EXPECT_TRUE(tiers.contains(Tier::kDefault)) << path;
  }
}

TEST_F(ExperimentTest, MissingFileAndFolderAreNamed) {
  EXPECT_THROW(read_experiment(folder_ / "absent.toml"), InputError);
  EXPECT_THROW(read_experiment(folder_.path()), InputError);
  EXPECT_THROW(experiment_files(folder_ / "absent"), InputError);
}

TEST_F(ExperimentTest, FilesOfAFolderAreItsTomlFilesSorted) {
  for (const char* name : {"b.toml", "a.toml", "README.md"}) folder_.write(name, "");
  EXPECT_EQ(experiment_files(folder_.path()),
            (std::vector<std::string>{folder_ / "a.toml", folder_ / "b.toml"}));
}

}  // namespace
}  // namespace podm::bench
