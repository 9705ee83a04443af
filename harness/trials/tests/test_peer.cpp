// Tests of trials of a peer: its contract is harness/peers/README.md.
#include <gtest/gtest.h>

#include <filesystem>

#include "errors.h"
#include "tests/fake_mesher.h"
#include "trials/trial.h"

namespace podm::bench {
namespace {

class PeerTest : public testing::Test {
 protected:
  // Runs a peer whose `run` answers --version with `version` and then executes `body`.
  TrialResult run(const std::string& version, const std::string& body, const std::string& verdicts = "{}") {
    std::filesystem::create_directories(folder_ / "other");
    folder_.script("other/run", "[ \"$1\" = --version ] && { " + version + R"(; }
echo "$@" > "$(dirname "$0")/arguments"
while [ $# -gt 0 ]; do
  case $1 in --output) output=$2;; esac
  shift
done
)" + body);
    Trial trial;
    trial.name = "some";
    trial.image = "image.nii";
    trial.options = {{"mesher", "other"}, {"threads", 2}, {"radius_mm", 2.5}};
    trial.timeout_s = 20;
    const std::string verifier =
        fake_verifier(folder_, "echo '{\"claims\":" + verdicts + "}' > \"$report\"\n");
    const Programs programs{fake_mesher(folder_, "exit 3"), verifier, folder_.path()};
    TrialRunner runner(programs);
    reason_to_skip_ = runner.why_skipped(trial);
    return reason_to_skip_.empty() ? runner.run(trial, prepared(trial), folder_.path()) : TrialResult{};
  }
  static std::string record(const std::string& more = "") {
    return R"(echo '{"mesh":"other.msh","cells":100,"vertices":30,"phases_s":{"refine":2.0})" + more +
           "}' > $output/record.jsonl; echo mesh > $output/other.msh\n";
  }
  TemporaryFolder folder_;
  std::string reason_to_skip_;
  const std::string version_ = "echo 'Other 1.0, MIT'; exit 0";
};

TEST_F(PeerTest, GetsTheSizesAndItsMeshAndRecordCount) {
  const TrialResult result = run(version_, record());
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  const std::string arguments = read_tail(folder_ / "other/arguments", 1000);
  EXPECT_NE(arguments.find(" --image image.nii --output " + folder_.path() + " --threads 2 --radius 2.5"),
            std::string::npos)
      << arguments;
  ASSERT_TRUE(result.mesh);
  EXPECT_EQ(result.mesh->refine_cells_per_second, 50.0);
  EXPECT_EQ(result.mesh_bytes, 5u);
  EXPECT_EQ(result.peer.value().version, "Other 1.0, MIT");
}

TEST_F(PeerTest, AnswersForTheClaimsItPromises) {
  const std::string verdicts = R"({"structure":{"verdict":"pass"},"size":{"verdict":"fail"}})";
  TrialResult promised = run(version_, record(R"(,"promises":["structure"])"), verdicts);
  EXPECT_EQ(promised.status, Status::kOk) << promised.reason;
  EXPECT_EQ(promised.mesh.value().verdicts.value()["size"], Proof::kFail) << "all verdicts are recorded";
  EXPECT_EQ(run(version_, record(R"(,"promises":["size"])"), verdicts).status, Status::kUnmet);
  EXPECT_EQ(run(version_, record(), verdicts).status, Status::kUnmet) << "without promises all count";
}

TEST_F(PeerTest, IsSkippedWithItsReasonWhereItCannotRun) {
  run("echo 'other is not installed'; exit 77", record());
  EXPECT_EQ(reason_to_skip_, "other is not installed");
}

TEST_F(PeerTest, IsSkippedWithItsReasonWhereItCannotTakeTheImage) {
  const TrialResult result = run(version_, "echo 'only cubes' >&2; exit 77");
  EXPECT_EQ(result.status, Status::kSkipped);
  EXPECT_EQ(result.reason, "only cubes");
}

TEST_F(PeerTest, FailsWithoutAUsableRecord) {
  EXPECT_EQ(run(version_, "exit 4").status, Status::kFailed);
  EXPECT_EQ(run(version_, "echo '{\"cells\":1}' > $output/record.jsonl\n").status, Status::kFailed);
  EXPECT_EQ(run(version_, "echo nothing > $output/record.jsonl\n").status, Status::kFailed);
}

TEST_F(PeerTest, IsAnotherWithAnotherProgramVersionOrSharedPart) {
  std::filesystem::create_directories(folder_ / "other");
  const Peer peer{folder_.script("other/run", "exit 0"), "Other 1.0", {}};
  const std::string before = peer.sha256();
  EXPECT_EQ(peer.sha256(), before);
  EXPECT_NE((Peer{peer.program, "Other 1.1", {}}.sha256()), before);
  folder_.write("shared.py", "shared");
  const std::string with_shared = peer.sha256();
  EXPECT_NE(with_shared, before);
  folder_.script("other/run", "exit 1");
  EXPECT_NE(peer.sha256(), with_shared);
}

TEST(Peers, UnknownNamesAreRefused) {
  Trial trial;
  trial.name = "some";
  trial.options = {{"mesher", "nobody"}};
  EXPECT_THROW(Peers("/tmp", "podm").of(trial), InputError);
}

}  // namespace
}  // namespace podm::bench
