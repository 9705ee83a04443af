// Tests of trials counted by valgrind and likwid-perfctr: real if installed, simulated by scripts, absent, or
// failing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>

#include "rows/codec.h"
#include "tests/fake_mesher.h"
#include "trials/counter_tool.h"
#include "trials/trial.h"

namespace podm::bench {
namespace {

const std::string kSourcesOfGroups = PODM_LIKWID_GROUPS;

// Heads of scripts that play the tools. They read the tool's own options and leave the command to the rest.
const std::string kValgrindHead = R"(
while [ "${1#--}" != "$1" ]; do
  case $1 in --cachegrind-out-file=*) out=${1#*=};; esac
  shift
done
)";
const std::string kLikwidHead = R"(
[ "$1" = -i ] && { printf 'CPU name:\tSome\nCPU short:\tsome\n'; exit 0; }
events=$5; out=$7; shift 7
)";
const std::string kGroup = "SHORT x\n\nEVENTSET\nPMC0  LOADS\nPMC1 MISSES\nPMC2 OTHERS\n\nMETRICS\nx PMC0\n";

class CounterToolTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::getenv("PATH");
    std::filesystem::create_directories(folder_ / "groups/some");
    folder_.write("groups/some/CACHE.txt", kGroup);
  }
  void TearDown() override { setenv("PATH", path_.c_str(), 1); }

  // Provides the shell's programs and those of the test, but neither valgrind nor likwid.
  void hide_tools() {
    std::filesystem::create_directory(folder_ / "bin");
    for (const char* program : {"dirname", "true"})
      std::filesystem::create_symlink(std::string("/usr/bin/") + program, folder_ / "bin/" + program);
    setenv("PATH", (folder_ / "bin").c_str(), 1);
  }
  TrialResult run(const std::string& counters) {
    Trial trial;
    trial.name = "some";
    trial.image = "image.nii";
    trial.options = {{"threads", 1}, {"counters", counters}};
    trial.timeout_s = 20;
    const std::string mesher = fake_mesher(folder_, "echo '" + kGoodRecord + "' > \"$record\"\n");
    return TrialRunner({.podm = mesher, .verifier = {}, .likwid_groups = folder_ / "groups"})
        .run(trial, prepared(trial), folder_.path());
  }
  Json counters_of(const std::string& choice) { return to_json(run(choice).counters); }

  TemporaryFolder folder_;

 private:
  std::string path_;
};

TEST_F(CounterToolTest, ValgrindSimulatesARealProgram) {
  const Cachegrind cachegrind;
  if (!cachegrind.absence().empty()) GTEST_SKIP() << "skipped: " << cachegrind.absence();
  const ProcessOutcome outcome = run_process({.arguments = cachegrind.wrap({"/bin/true"}, folder_.path()),
                                              .stdout_path = {},
                                              .stderr_path = {},
                                              .timeout_s = 60});
  ASSERT_TRUE(outcome.succeeded()) << outcome.describe();
  const Json counts = to_json(cachegrind.read(folder_.path()));
  for (const auto& [name, count] : counts.items())
    EXPECT_NE(count["source"].get<std::string>().find("simulated"), std::string::npos) << name;
  const auto value = [&](const char* name) { return counts[name]["value"].get<std::uint64_t>(); };
  EXPECT_GT(value("instructions"), value("loads"));
  EXPECT_GT(value("loads"), value("l1_load_misses"));
  EXPECT_GE(value("l1_load_misses"), value("llc_load_misses"));
  EXPECT_GE(value("l1_store_misses"), value("llc_store_misses"));
  EXPECT_GT(value("llc_load_misses"), 0u) << "a program starts with cold caches";
}

TEST_F(CounterToolTest, SimulatedCountsStandAlone) {
  hide_tools();
  folder_.script("bin/valgrind", kValgrindHead + R"(
printf 'desc: x\nevents: Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw \n1 2 3\nsummary: 9 8 7 6 5 4 3 2 1\n' > "$out"
exec "$@")");
  const TrialResult result = run("cachegrind");
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  EXPECT_EQ(result.command.front(), "valgrind");
  EXPECT_EQ(to_json(result.counters).size(), 9u)
      << "those of valgrind's own process are none of the mesher's";
  EXPECT_EQ(to_json(result.counters)["instructions"]["value"], 9);
  EXPECT_EQ(to_json(result.counters)["l1_load_misses"]["value"], 5);
  EXPECT_EQ(to_json(result.counters)["llc_store_misses"]["value"], 1);
}

TEST_F(CounterToolTest, SimulationThatWasCutShortIsUnavailable) {
  hide_tools();
  for (const char* text : {"", "events: Ir Bc \\nsummary: 1 2\\n",
                           "events: Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw \\nsummary: 9 8 7\\n",
                           "events: Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw \\n1 2 3\\n"}) {
    folder_.script("bin/valgrind", kValgrindHead + "printf '" + text + "' > \"$out\"\nexec \"$@\"");
    const Json counters = to_json(run("cachegrind").counters);
    ASSERT_EQ(counters.size(), 1u) << text;
    EXPECT_TRUE(counters["cachegrind"].get<std::string>().starts_with("unavailable: ")) << text;
  }
}

TEST_F(CounterToolTest, WithoutTheToolTheTrialRunsAndSaysWhy) {
  hide_tools();
  for (const auto& [choice, program] :
       {std::pair{"cachegrind", "valgrind"}, {"likwid:CACHE", "likwid-perfctr"}}) {
    const TrialResult result = run(choice);
    EXPECT_EQ(result.status, Status::kOk) << result.reason;
    EXPECT_EQ(to_json(result.counters)[choice], std::string("unavailable: ") + program + " is not installed");
    EXPECT_TRUE(to_json(result.counters).contains("cycles")) << "the kernel's are there";
  }
}

TEST_F(CounterToolTest, LikwidsCountsAreSummedOverProcessors) {
  hide_tools();
  folder_.script("bin/likwid-perfctr", kLikwidHead + R"(
echo "$events" > "$(dirname "$0")/events"
printf 'TABLE,Group 1 Raw,Custom,3\nEvent,Counter,HWThread 0,HWThread 1\nRuntime (RDTSC) [s],TSC,1.5,1.5\nLOADS,PMC0,100,2e3\nMISSES,PMC1,7,-\nOTHERS,PMC2,-,nan\n' > "$out"
exec "$@")");
  const TrialResult result = run("likwid:CACHE");
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  EXPECT_EQ(read_tail(folder_ / "bin/events", 100), "LOADS:PMC0,MISSES:PMC1,OTHERS:PMC2\n");
  EXPECT_EQ(to_json(result.counters)["LOADS"],
            Json({{"value", 2100.0}, {"source", "likwid-perfctr, group CACHE"}}));
  EXPECT_EQ(to_json(result.counters)["MISSES"]["value"], 7);
  EXPECT_FALSE(to_json(result.counters).contains("OTHERS")) << "not counted is not 0";
  EXPECT_TRUE(to_json(result.counters).contains("page_faults"));
  EXPECT_FALSE(to_json(result.counters).contains("cycles")) << "likwid has the processor's counters";
  EXPECT_FALSE(to_json(result.counters).contains("Runtime (RDTSC) [s]"));
}

TEST_F(CounterToolTest, LikwidThatMayNotCountSaysWhyAndTheTrialRuns) {
  hide_tools();
  folder_.script("bin/likwid-perfctr", kLikwidHead + "echo 'Cannot access MSR device' >&2; exit 1");
  const TrialResult refused = run("likwid:CACHE");
  EXPECT_EQ(refused.status, Status::kOk) << refused.reason;
  EXPECT_EQ(to_json(refused.counters)["likwid:CACHE"],
            "unavailable: likwid-perfctr: Cannot access MSR device");
  EXPECT_NE(refused.command.front(), "likwid-perfctr");

  folder_.script("bin/likwid-perfctr", kLikwidHead + "exit 0");
  const Json no_file = counters_of("likwid:CACHE")["likwid:CACHE"];
  EXPECT_EQ(no_file, "unavailable: likwid-perfctr wrote no counts");
  const Json no_group = counters_of("likwid:ABSENT")["likwid:ABSENT"];
  EXPECT_NE(no_group.get<std::string>().find("some/ABSENT.txt"), std::string::npos) << no_group;
}

// likwid 5.2 does this on a processor that is newer than likwid.
TEST_F(CounterToolTest, LikwidThatDoesNotKnowTheProcessorSaysSoInItsOwnWords) {
  hide_tools();
  const std::string head = "[ \"$1\" = -i ] && { printf 'CPU name:\\tNew\\nCPU short:\\tnil\\n'; exit 0; }\n";
  folder_.script("bin/likwid-perfctr",
                 head + "echo ERROR - Unsupported Processor >&2; echo No access >&2; exit 1");
  EXPECT_EQ(counters_of("likwid:NUMA")["likwid:NUMA"],
            "unavailable: likwid-perfctr: ERROR - Unsupported Processor; No access");
  folder_.script("bin/likwid-perfctr", head + "exit 0");
  EXPECT_EQ(counters_of("likwid:NUMA")["likwid:NUMA"],
            "unavailable: likwid-perfctr does not know this processor");
  folder_.script("bin/likwid-perfctr", "exit 3");
  EXPECT_TRUE(counters_of("likwid:NUMA")["likwid:NUMA"].get<std::string>().starts_with(
      "unavailable: likwid-perfctr: "))
      << "how it ended, at least";
}

// Runs likwid's real program, if it is installed, for each group.
TEST_F(CounterToolTest, TheRealLikwidCountsOrSaysWhyNot) {
  for (const char* group : {"CACHE", "NUMA"}) {
    const Likwid likwid(group, kSourcesOfGroups, folder_.path());
    if (likwid.absence() == "likwid-perfctr is not installed")
      GTEST_SKIP() << "skipped: " << likwid.absence();
    if (likwid.absence().empty()) continue;
    EXPECT_TRUE(likwid.absence().starts_with("likwid-perfctr")) << likwid.absence();
    EXPECT_EQ(likwid.absence().find('\n'), std::string::npos) << "one line of a row";
  }
}

// The counters of a file's EVENTSET, and the formulas of its METRICS.
struct Group {
  std::set<std::string> counters;
  std::vector<std::string> formulas;  // the last word of each line
};
Group read_group(const std::filesystem::path& path) {
  std::ifstream file(path);
  Group group;
  std::string part;
  for (std::string line; std::getline(file, line);) {
    if (line == "EVENTSET" || line == "METRICS" || line == "LONG") {
      part = line;
    } else if (!line.empty() && part == "EVENTSET") {
      EXPECT_TRUE(group.counters.insert(line.substr(0, line.find(' '))).second) << path << ": " << line;
    } else if (!line.empty() && part == "METRICS") {
      group.formulas.push_back(line.substr(line.rfind(' ') + 1));
    }
  }
  return group;
}

TEST(LikwidGroups, EveryArchitectureHasCachesAndNodes) {
  std::size_t number = 0;
  for (const auto& architecture : std::filesystem::directory_iterator(kSourcesOfGroups)) {
    for (const char* name : {"CACHE.txt", "NUMA.txt"}) {
      const std::filesystem::path path = architecture.path() / name;
      const Group group = read_group(path);
      const std::string events = events_of_group(path.string());
      EXPECT_EQ(static_cast<std::size_t>(std::count(events.begin(), events.end(), ':')),
                group.counters.size())
          << path;
      EXPECT_GT(group.counters.size(), 2u) << path;
      ++number;
    }
  }
  EXPECT_GT(number, 0u);
  EXPECT_EQ(events_of_group("/no/such/file"), "");
}

// likwid refuses a formula with a counter that the group does not set.
TEST(LikwidGroups, FormulasUseTheGroupsOwnCounters) {
  const std::regex kCounter("[A-Z]+[0-9]+(C[0-9]+)?");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kSourcesOfGroups)) {
    if (entry.path().extension() != ".txt") continue;
    const Group group = read_group(entry.path());
    EXPECT_FALSE(group.formulas.empty()) << entry.path();
    for (const std::string& formula : group.formulas)
      for (std::sregex_iterator found(formula.begin(), formula.end(), kCounter), end; found != end; ++found)
        EXPECT_TRUE(group.counters.contains(found->str())) << entry.path() << ": " << formula;
  }
}

}  // namespace
}  // namespace podm::bench
