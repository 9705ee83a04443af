#include <gtest/gtest.h>

#include "experiment.h"
#include "fake_mesher.h"

namespace podm::bench {
namespace {

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
  Experiment read(const std::string& text) { return read_experiment(folder_.write("some.toml", text)); }
  // What read_experiment() says of the text, without the folder.
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
expected_minutes = 1.5
timeout_s = 7
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
[[trials]]
name = "second"
input = "file"
target_elements = 1_000
)");
  EXPECT_EQ(experiment.name, "some");
  EXPECT_EQ(experiment.title, "Title");
  EXPECT_EQ(experiment.claim, "Claim");
  EXPECT_EQ(experiment.expected_minutes, 1.5);
  ASSERT_EQ(experiment.trials.size(), 2u);
  const Trial& first = experiment.trials[0];
  EXPECT_EQ(first.name, "first");
  EXPECT_EQ(first.image, "phantom:torus@64");
  EXPECT_FALSE(first.if_exists);
  EXPECT_EQ(first.radius_mm, 2);
  EXPECT_EQ(first.delta_mm, 0.5);
  EXPECT_EQ(first.threads, 4);
  EXPECT_EQ(first.timeout_s, 9);
  const Trial& second = experiment.trials[1];
  EXPECT_EQ(second.image, folder_ / "data/head.nii");  // beside the experiment
  EXPECT_TRUE(second.if_exists);
  EXPECT_EQ(second.target_elements, 1000u);
  EXPECT_EQ(second.radius_mm, 0);
  EXPECT_EQ(second.threads, 1);
  EXPECT_EQ(second.timeout_s, 7);  // the experiment's
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
      {"title = \"T\"\nclaim = = 1\n", "some.toml:2:", ""},                     // no TOML
      {"colour = 1\n" + kHead + kTrial, "some.toml:1:1:", "colour"},            // unknown keys, anywhere
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
      {kHead + kTrial + "threads = 0\n", "some.toml:8:11:", "threads"},
      {kHead + kTrial + "target_elements = -5\n", "some.toml:8:19:", "target_elements"},
      {kHead + "[[trials]]\nname = '../x'\ninput = 'a'\n", "some.toml:6:8:", "name"},  // would be a path
      {kHead + "[[trials]]\nname = ''\ninput = 'a'\n", "some.toml:6:8:", "name"},
      {kHead + "[[trials]]\nname = 'x'\ninput = 'b'\n", "some.toml:7:9:", "inputs.b"},  // contradictions
      {kHead + kTrial + kTrial, "some.toml:9:8:", "one"},
      {kHead + kTrial + "radius_mm = 1\ntarget_elements = 5\n", "some.toml:9:19:", "exclude"},
      {kHead, "some.toml:1:", "trials"},  // what is missing
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
