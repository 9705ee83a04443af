// Tests of inputs that are made once before trials run: phantoms as files, and the radius of a target number
// of cells.
#include <gtest/gtest.h>

#include <sstream>

#include "machine/machine.h"
#include "process/usable_processors.h"
#include "tests/fake_mesher.h"
#include "trials/preparation.h"

namespace podm::bench {
namespace {

Trial some_trial(const std::string& image, const Json& options) {
  Trial trial;
  trial.name = "some";
  trial.image = image;
  trial.options = options;
  trial.timeout_s = 20;
  return trial;
}

const Json kTarget = {{"threads", 1}, {"target_elements", 1000}};

// Notes each mesh in the file "meshed".
const std::string kFindsRadius = R"(echo x >> "$(dirname "$0")/meshed"
echo '{"stop_reason":"complete","cells":990,"program":"podm 9.9","used":{"radius_mm":2.25,"delta_mm":1.125}}' \
  > "$record"
)";

class PreparationTest : public testing::Test {
 protected:
  // Returns a new preparer, as in a separate run; each hash stands for another mesher.
  Preparer preparer(const std::string& mesher_sha256 = "m", const std::string& mesh_body = kFindsRadius) {
    return {fake_mesher(folder_, mesh_body), mesher_sha256, folder_ / "results"};
  }
  Preparation make(Preparer& preparer, const Trial& trial) {
    std::filesystem::create_directories(folder_ / "results/scratch");
    return preparer.make(trial, folder_ / "results/scratch",
                         [&](const std::string& what) { announced_ += what + "\n"; }, {});
  }
  std::size_t lines_of(const std::string& name) {
    std::istringstream lines(read_tail(folder_ / name, 10000));
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) ++number;
    return number;
  }
  TemporaryFolder folder_;
  std::string announced_;
};

TEST_F(PreparationTest, PhantomIsDrawnOnceByEachMesher) {
  const Trial trial = some_trial("phantom:torus@32", {{"threads", 1}});
  Preparer first = preparer();
  EXPECT_EQ(first.find(trial), std::nullopt);
  const Preparation drawn = make(first, trial);
  EXPECT_EQ(drawn.image, folder_ / "results/inputs/torus@32.nii.gz");
  EXPECT_EQ(read_tail(drawn.image, 100), "torus 32\n");
  EXPECT_EQ(drawn.sha256, sha256_of_file(drawn.image));
  Preparer second = preparer();
  ASSERT_TRUE(second.find(trial).has_value());
  EXPECT_EQ(second.find(trial)->sha256, drawn.sha256);
  make(second, trial);
  EXPECT_EQ(lines_of("drawn"), 1u);
  Preparer of_another = preparer("another mesher");
  EXPECT_EQ(of_another.find(trial), std::nullopt) << "it may draw another phantom";
  make(of_another, trial);
  EXPECT_EQ(lines_of("drawn"), 2u);
}

TEST_F(PreparationTest, PhantomWithoutSizeHasTheMeshersOwn) {
  Preparer any = preparer();
  EXPECT_EQ(read_tail(make(any, some_trial("phantom:torus", {{"threads", 1}})).image, 100), "torus 10\n");
}

TEST_F(PreparationTest, FileIsReadWhereItIs) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), {{"threads", 1}});
  Preparer any = preparer();
  ASSERT_TRUE(any.find(trial).has_value());
  EXPECT_EQ(any.find(trial)->image, trial.image);
  EXPECT_FALSE(any.find(trial)->resolved);
  EXPECT_EQ(any.find(some_trial(folder_ / "absent.nii", {}))->sha256, "absent") << "its mesher says so";
}

TEST_F(PreparationTest, LengthsInVoxelsAreMillimetresOfTheImage) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"),
                                 {{"threads", 1}, {"smooth_voxels", 1.5}, {"delta_voxels", 2}});
  Preparer any = preparer();
  EXPECT_EQ(any.find(trial), std::nullopt) << "its voxels are not known yet";
  const Preparation made = make(any, trial);
  EXPECT_EQ(made.voxel_mm, 2.0);
  EXPECT_EQ(resolved_options(trial, made), Json({{"threads", 1}, {"smooth", 3.0}, {"delta_mm", 4.0}}));
  ASSERT_TRUE(any.find(trial).has_value());
  EXPECT_EQ(any.find(trial)->voxel_mm, 2.0);
  EXPECT_EQ(resolved_options(some_trial(trial.image, {{"threads", 1}}), *any.find(trial)),
            Json({{"threads", 1}}));
}

TEST_F(PreparationTest, LengthsInVoxelsOfAnImageThatIsRefusedAreNoTrial) {
  const Trial trial =
      some_trial(folder_.write("refused.nii", "voxels"), {{"threads", 1}, {"smooth_voxels", 1}});
  Preparer any = preparer();
  try {
    make(any, trial);
    FAIL() << "no exception";
  } catch (const PreparationError& error) {
    EXPECT_STREQ(error.what(), "the size of voxels is not known: exit code 2");
    EXPECT_EQ(error.stderr_tail, "refused\n");
  }
}

TEST_F(PreparationTest, RadiusIsFoundOnceOnAllProcessorsAndStoredWithItsEvidence) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), kTarget);
  Preparer first = preparer();
  EXPECT_EQ(first.find(trial), std::nullopt);
  const ResolvedRadius found = make(first, trial).resolved.value();
  EXPECT_EQ(found.radius_mm, 2.25);
  EXPECT_EQ(found.delta_mm, 1.125);
  EXPECT_EQ(found.target_elements, 1000u);
  EXPECT_EQ(found.cells, 990u);
  EXPECT_NE(announced_.find("1000 cells"), std::string::npos) << announced_;
  const std::string asked = read_tail(folder_ / "arguments", 1000);
  EXPECT_NE(asked.find("--target-elements 1000 --threads " + std::to_string(usable_processors())),
            std::string::npos)
      << asked;
  const Json line = Json::parse(read_tail(folder_ / "results/radii.jsonl", 10000));
  EXPECT_EQ(line["mesher"], Json({{"sha256", "m"}, {"version", "podm 9.9"}}));
  EXPECT_EQ(line["input"]["sha256"], sha256_of_file(trial.image));
  EXPECT_GT(line["command"].size(), 5u);
  EXPECT_GT(line["seconds"], 0);

  Preparer second = preparer();
  ASSERT_TRUE(second.find(trial).has_value());
  EXPECT_EQ(second.find(trial)->resolved, found);
  EXPECT_EQ(make(second, trial).resolved, found);
  Trial other_settings = trial;
  other_settings.options.update({{"threads", 7}, {"algorithm", "pdr-podm"}, {"executor", "virtual"}});
  EXPECT_EQ(make(second, other_settings).resolved, found) << "they do the same work";
  EXPECT_EQ(lines_of("meshed"), 1u);
}

TEST_F(PreparationTest, RadiusIsAnotherOnesForAnotherImageNumberDeltaOrMesher) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), kTarget);
  Preparer any = preparer();
  make(any, trial);
  Trial other = trial;
  other.image = folder_.write("other.nii", "other voxels");
  EXPECT_EQ(any.find(other), std::nullopt);
  other = trial;
  other.options["target_elements"] = 2000;
  EXPECT_EQ(any.find(other), std::nullopt);
  other = trial;
  other.options["delta_mm"] = 0.5;
  EXPECT_EQ(any.find(other), std::nullopt);
  make(any, other);
  EXPECT_NE(read_tail(folder_ / "arguments", 1000).find("--delta 0.5"), std::string::npos);
  EXPECT_EQ(preparer("another").find(trial), std::nullopt);
  other = trial;
  other.image = folder_.write("copy.nii", "voxels");
  EXPECT_TRUE(any.find(other).has_value()) << "the file's bytes count, not its name";
}

TEST_F(PreparationTest, NumberOfMeshesIsThatOfTheMesherWhereItReportsIt) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), kTarget);
  Preparer silent = preparer();
  EXPECT_FALSE(make(silent, trial).resolved.value().meshes);
  Preparer reporting =
      preparer("t", R"(echo '{"stop_reason":"complete","cells":990,"used":{"radius_mm":2,"delta_mm":1},
"calibration":{"meshes":[{"radius_mm":4,"cells":120,"seconds":0.1}],"seconds":0.1}}' | tr -d '\n' > "$record")");
  EXPECT_EQ(make(reporting, trial).resolved.value().meshes, 2u) << "the coarse one and the last";
}

TEST_F(PreparationTest, RadiusThatIsNotFoundIsAFaultAndTriedOnce) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), kTarget);
  const std::string note = "echo x >> \"$(dirname \"$0\")/meshed\"\n";
  const std::string useless[] = {
      "echo 'podm: no foreground' >&2; exit 2", "exit 0",
      R"(echo '{"stop_reason":"time limit","cells":1,"used":{"radius_mm":2,"delta_mm":1}}' > "$record"; exit 1)"};
  for (const std::string& body : useless) {
    std::filesystem::remove(folder_ / "meshed");
    std::filesystem::remove_all(folder_ / "results");
    Preparer failing = preparer("m", note + body);
    for (int repeat = 0; repeat < 2; ++repeat) {
      try {
        make(failing, trial);
        ADD_FAILURE() << body;
      } catch (const PreparationError& error) {
        EXPECT_NE(std::string(error.what()).find("no radius for 1000 cells"), std::string::npos);
        EXPECT_GE(error.command.size(), 3u);
      }
    }
    EXPECT_EQ(lines_of("meshed"), 1u);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "results/radii.jsonl"));
  }
}

TEST_F(PreparationTest, BrokenLineOfRadiiIsPassedOver) {
  const Trial trial = some_trial(folder_.write("image.nii", "voxels"), kTarget);
  Preparer first = preparer();
  make(first, trial);
  std::ofstream(folder_ / "results/radii.jsonl", std::ios::app) << R"({"schema":"podm-bench-)";
  EXPECT_TRUE(preparer().find(trial).has_value());
}

TEST_F(PreparationTest, MeasurementOfTheMachineNeedsNothing) {
  EXPECT_TRUE(preparer().find(some_trial("", {{"measure", "memory_latency"}})).has_value());
}

}  // namespace
}  // namespace podm::bench
