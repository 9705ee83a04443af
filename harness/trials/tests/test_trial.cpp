// Tests of trials whose mesher succeeds, fails, hangs, writes false records or is absent.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "machine/machine.h"
#include "process/programs.h"
#include "process/usable_processors.h"
#include "rows/codec.h"
#include "tests/fake_mesher.h"
#include "trials/ranks.h"
#include "trials/trial.h"

namespace podm::bench {
namespace {

Trial some_trial() {
  Trial trial;
  trial.name = "some";
  trial.image = "image.nii";
  trial.options = {{"threads", 1}, {"radius_mm", 2.5}};
  trial.timeout_s = 20;
  return trial;
}

class TrialTest : public testing::Test {
 protected:
  TrialResult run(const std::string& mesh_body, const Trial& trial = some_trial()) {
    return TrialRunner({fake_mesher(folder_, mesh_body), {}}).run(trial, prepared(trial), folder_.path());
  }
  static std::string write_record(const std::string& record) {
    return "echo '" + record + "' > \"$record\"\n";
  }
  static std::string good_record_but(const std::string& from, const std::string& to) {
    std::string record = kGoodRecord;
    record.replace(record.find(from), from.size(), to);
    return write_record(record);
  }
  TemporaryFolder folder_;
};

TEST_F(TrialTest, GoodRunIsOkWithItsRecordAndImageSize) {
  const TrialResult result = run(write_record(kGoodRecord));
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.reason, "");
  ASSERT_TRUE(result.mesh);
  EXPECT_EQ(to_json(*result.mesh), Json::parse(kGoodRecord));
  EXPECT_EQ(result.image_size, (ImageSize{10, 10, 10}));
  EXPECT_GT(result.process.peak_rss_bytes, 0u);
}

TEST_F(TrialTest, VerdictsOfTheVerifierDecide) {
  const std::string mesher = fake_mesher(folder_, write_record(kGoodRecord));
  const auto run_with_verifier = [&](const std::string& body) {
    return TrialRunner({mesher, fake_verifier(folder_, body)})
        .run(some_trial(), prepared(some_trial()), folder_.path());
  };
  const TrialResult proved =
      run_with_verifier(R"(echo '{"claims":{"size":{"verdict":"pass"}}}' > "$report")");
  EXPECT_EQ(proved.status, Status::kOk);
  EXPECT_EQ(to_json(proved.mesh.value().verdicts), Json({{"size", "pass"}}));

  const TrialResult refuted =
      run_with_verifier(R"(echo '{"claims":{"size":{"verdict":"fail"}}}' > "$report"; exit 1)");
  EXPECT_EQ(refuted.status, Status::kUnmet);
  EXPECT_EQ(refuted.reason, "size fail");

  std::filesystem::remove(folder_ / "verification.json");
  EXPECT_EQ(run_with_verifier("exit 3").status, Status::kUnmet) << "no report proves nothing";
}

TEST_F(TrialTest, DihedralAnglesAreThoseThatTheVerifierCounts) {
  const std::string report =
      R"({"claims":{"size":{"verdict":"pass","histograms":[]},"radius_edge":{"verdict":"pass","histograms":[)"
      R"({"name":"other","minimum":null,"maximum":null,"counts":[]},)"
      R"({"name":"dihedral_angle","minimum":7.5,"maximum":160.25,"counts":[0,4,2]}]}}})";
  const std::string mesher = fake_mesher(folder_, write_record(kGoodRecord)),
                    verifier = fake_verifier(folder_, "echo '" + report + "' > \"$report\"");
  const TrialResult result =
      TrialRunner({mesher, verifier}).run(some_trial(), prepared(some_trial()), folder_.path());
  EXPECT_EQ(to_json(result.mesh.value().dihedral_deg),
            Json({{"least", 7.5}, {"largest", 160.25}, {"counts", {0, 4, 2}}}));
}

TEST_F(TrialTest, TopologyIsTheVerifiersCountBesideTheImages) {
  const auto topology_of = [&](const std::string& labels) {
    const std::string report =
        R"({"claims":{"surface":{"verdict":"pass","details":{"labels":[)" + labels + "]}}}}";
    const std::string mesher = fake_mesher(folder_, write_record(kGoodRecord)),
                      verifier = fake_verifier(folder_, "echo '" + report + "' > \"$report\"");
    return TrialRunner({mesher, verifier})
        .run(some_trial(), prepared(some_trial()), folder_.path())
        .mesh.value()
        .topology;
  };
  const std::string image = R"("image":{"components_6":3,"components_26":2,"euler_6":4,"euler_26":1})";
  const std::string same = R"({"components":2,"euler":1,)" + image + "}",
                    between = R"({"components":3,"euler":2,)" + image + "}",
                    torn = R"({"components":4,"euler":4,)" + image + "}",
                    holed = R"({"components":2,"euler":0,)" + image + "}",
                    no_image = R"({"components":2,"euler":1})";
  EXPECT_EQ(to_json(topology_of(same + "," + between + "," + torn + "," + holed)),
            Json({{"labels", 4}, {"components_as_image", 3}, {"euler_as_image", 3}}));
  EXPECT_FALSE(topology_of(same + "," + no_image)) << "nothing to compare with";
}

TEST_F(TrialTest, DistancesAreThoseOfTheClaimsThatMeasureThem) {
  const std::string report =
      R"({"claims":{"box":{"verdict":"pass","details":{"most_ulps_off":1.25}},)"
      R"("fidelity":{"verdict":"fail","details":{"mesh_to_image":{"max_mm":0.5,"p95_mm":0.1},"labels":[]}},)"
      R"("lines":{"verdict":"fail","details":{"lines_delta_mm":2.5,"line_edges":7,"length_mm":12.5,"space":"RAS",)"
      R"("image_to_mesh":{"share_near":0.75,"furthest_mm":null,"far_places":3},)"
      R"("mesh_to_image":{"share_near":1.0,"furthest_mm":0.5,"far_places":0}}}}})";
  const std::string mesher = fake_mesher(
      folder_, write_record(R"({"schema":1,"phases_s":{"refine":1},"cells":9,"vertices":6,)"
                            R"("refine_cells_per_second":9,"guarantees":{},"used":{"delta_mm":2},)"
                            R"("stop_reason":"complete"})"));
  const std::string verifier = fake_verifier(
      folder_, "echo '" + report + "' > \"$report\"; echo \"$asked\" >> " + folder_.path() + "/asked");
  Trial trial = some_trial();
  const auto run = [&] {
    return TrialRunner({mesher, verifier}).run(trial, prepared(trial), folder_.path()).mesh.value();
  };
  const MeshRecord alone = run();
  EXPECT_EQ(alone.box_ulps_off, 1.25);
  EXPECT_EQ(alone.interface_distance_mm, 0.5);
  EXPECT_FALSE(alone.line_distances) << "they were not asked for";
  trial.options[kLineDistances] = true;
  const MeshRecord asked = run();
  ASSERT_TRUE(asked.line_distances);
  EXPECT_EQ(asked.line_distances->line_edges, 7u);
  EXPECT_EQ(asked.line_distances->image_to_mesh.share_near, 0.75);
  EXPECT_FALSE(asked.line_distances->image_to_mesh.furthest_mm) << "a line has no counterpart";
  EXPECT_NE(read_tail(folder_ / "asked", 1000).find("--claims lines --lines-delta 2.5"), std::string::npos);
}

// A record with the claims and options by which podm-verify judges its mesh.
const std::string kJudged =
    R"("verify":{"claims":["structure","delaunay","size"],"options":["--delta","0.75","--size-near","1,0=2:3"]},)";

TEST_F(TrialTest, TheVerifierGetsTheClaimsAndOptionsOfTheRecord) {
  Trial trial = some_trial();
  trial.options["fidelity"] = false;
  const std::string verifier = folder_.script("podm-verify", "echo \"$@\" > \"$(dirname \"$0\")/asked\"");
  TrialRunner({fake_mesher(folder_, good_record_but(R"("cells")", kJudged + R"("cells")")), verifier})
      .run(trial, prepared(trial), folder_.path());
  const std::string asked = read_tail(folder_ / "asked", 1000);
  EXPECT_NE(asked.find("--claims structure,delaunay,size --delta 0.75 --size-near 1,0=2:3"),
            std::string::npos)
      << asked;
}

class SolvingTest : public TrialTest {
 protected:
  // Runs a trial that hands its mesh to a solver, which is a script.
  TrialResult run_with_solver(const std::string& body) {
    Trial trial = some_trial();
    trial.options["solve"] = true;
    Programs programs{fake_mesher(folder_, write_record(kGoodRecord) + "echo mesh > \"$output\"\n"), {}};
    programs.solver = folder_.script("solve", body);
    TrialRunner runner(programs);
    reason_to_skip_ = runner.why_skipped(trial);
    return runner.run(trial, prepared(trial), folder_.path());
  }
  std::string reason_to_skip_;
};

TEST_F(SolvingTest, RecordsWhatTheSolverPrintsOfTheMesh) {
  const TrialResult result = run_with_solver("[ -e \"$1\" ] && echo '" + kSolved + "'");
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  EXPECT_EQ(to_json(result.solve), Json::parse(kSolved));
  EXPECT_FALSE(run(write_record(kGoodRecord)).solve) << "it is not asked for";
}

TEST_F(SolvingTest, MeshesThatAreNotSolvedAreUnmet) {
  for (const auto& [body, fault] : {std::pair("echo flat >&2; exit 2", "flat"), {"echo '{}'", "solver"}}) {
    const TrialResult result = run_with_solver(body);
    EXPECT_EQ(result.status, Status::kUnmet);
    EXPECT_TRUE(result.reason.starts_with("not solved: ")) << result.reason;
    EXPECT_NE(result.reason.find(fault), std::string::npos) << result.reason;
    EXPECT_FALSE(result.solve);
  }
}

TEST_F(SolvingTest, TrialsAreSkippedWhereTheSolverCannotRun) {
  run_with_solver("echo 'no DOLFINx'; exit 77");
  EXPECT_EQ(reason_to_skip_, "no DOLFINx");
  run_with_solver("echo 'Solver 1.0'");
  EXPECT_EQ(reason_to_skip_, "");
}

TEST_F(TrialTest, OptionsOfTheTrialReachTheMesher) {
  Trial trial = some_trial();
  trial.options = {{"threads", 3},   {"delta_mm", 0.25},       {"cores_per_node", 8},
                   {"pin", true},    {"oversubscribe", false}, {"counters", "perf_event"},
                   {"solve", false}, {"min_dihedral", 8.0},    {"optimize", true}};
  run(write_record(kGoodRecord), trial);
  const std::string arguments = fmt::format(" {}", read_tail(folder_ / "arguments", 1000));
  EXPECT_TRUE(
      arguments.starts_with(" mesh image.nii --threads 3 --delta 0.25 --cores-per-node 8 --pin "
                            "--min-dihedral 8 --optimize -o "))
      << arguments;
  EXPECT_TRUE(arguments.ends_with(" --quiet\n")) << arguments;
}

Trial trial_on_ranks(const char* carrier) {
  Trial trial = some_trial();
  trial.options = {{"threads", 1}, {"radius_mm", 2.5}, {"ranks", 3}, {"carrier", carrier}};
  return trial;
}

TEST_F(TrialTest, TrialsOnRanksAreRunByPodmMpiBesidePodm) {
  const std::string podm = fake_mesher(folder_, "exit 9\n");
  folder_.script("podm-mpi", R"(
echo "$@" > "$(dirname "$0")/arguments"
while [ $# -gt 0 ]; do
  case $1 in --record) record=$2;; -o) index=$2;; esac
  shift
done
echo 12 > "$index"; echo 1234567 > "${index%.pvtu}_0.vtu"
)" + write_record(kGoodRecord));
  TrialRunner runner({podm, {}});
  Trial trial = trial_on_ranks("in-process");
  trial.options["network"] = "2,12.5";
  EXPECT_EQ(runner.why_skipped(trial), "");
  const TrialResult result = runner.run(trial, prepared(trial), folder_.path());
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  EXPECT_EQ(result.mesh_bytes, 3 + 8) << "index and pieces";
  const std::string arguments = read_tail(folder_ / "arguments", 1000);
  EXPECT_TRUE(
      arguments.starts_with("mesh --in-process 3 image.nii --threads 1 --radius 2.5 --network 2,12.5 -o "))
      << arguments;
  EXPECT_NE(arguments.find("/mesh.pvtu"), std::string::npos) << arguments;
}

TEST_F(TrialTest, TrialsOverMpiAreStartedByMpirun) {
  folder_.script("podm-mpi", "");
  folder_.script("mpirun", fmt::format("echo \"$@\" > {}", folder_ / "arguments"));
  const std::string path = std::getenv("PATH");
  setenv("PATH", fmt::format("{}:{}", folder_.path(), path).c_str(), 1);
  TrialRunner runner({fake_mesher(folder_, ""), {}});
  const Trial trial = trial_on_ranks("mpi");
  EXPECT_EQ(runner.why_skipped(trial), "");
  runner.run(trial, prepared(trial), folder_.path());
  setenv("PATH", path.c_str(), 1);
  const std::string arguments = read_tail(folder_ / "arguments", 1000);
  EXPECT_TRUE(arguments.starts_with("--oversubscribe -n 3 ")) << arguments;
  EXPECT_NE(arguments.find(podm_mpi_of(folder_ / "podm") + " mesh image.nii "), std::string::npos)
      << arguments;
}

TEST_F(TrialTest, TrialsOnRanksAreSkippedWherePodmMpiIsNotBuilt) {
  TrialRunner runner({fake_mesher(folder_, ""), {}});
  for (const char* carrier : {"mpi", "in-process"}) {
    const std::string why = runner.why_skipped(trial_on_ranks(carrier));
    EXPECT_NE(why.find("podm-mpi"), std::string::npos) << why;
    EXPECT_NE(why.find("MPI is found"), std::string::npos) << why;
  }
  EXPECT_EQ(runner.why_skipped(some_trial()), "");
}

TEST_F(TrialTest, ScheduleOfTheMesherReachesTheVerifier) {
  Trial trial = some_trial();
  trial.options["schedule"] = true;
  const std::string mesher = fake_mesher(folder_, write_record(kGoodRecord));
  const std::string verifier =
      folder_.script("podm-verify", "echo \"$@\" > \"$(dirname \"$0\")/verifier_arguments\"");
  TrialRunner({mesher, verifier}).run(trial, prepared(trial), folder_.path());
  const std::string option = " --schedule " + folder_.path() + "/schedule.jsonl";
  for (const char* program : {"arguments", "verifier_arguments"}) {
    const std::string arguments = fmt::format(" {}", read_tail(folder_ / program, 1000));
    EXPECT_NE(arguments.find(option), std::string::npos) << program << arguments;
  }
}

TEST_F(TrialTest, MemoryAboveTheLimitEndsTheTrial) {
  Trial trial = some_trial();
  trial.memory_limit_gib = 0.1;
  // dd holds a block of 300 MiB in memory.
  const TrialResult result = run("exec dd if=/dev/zero of=/dev/null count=1000 bs=300M", trial);
  EXPECT_EQ(result.status, Status::kFailed);
  EXPECT_NE(result.reason.find("memory limit"), std::string::npos) << result.reason;
  EXPECT_EQ(run(write_record(kGoodRecord), trial).status, Status::kOk);
}

TEST_F(TrialTest, EachImageIsLookedAtOnce) {
  const std::string mesher = fake_mesher(folder_, write_record(kGoodRecord));
  TrialRunner runner({mesher, {}});
  runner.run(some_trial(), prepared(some_trial()), folder_.path());
  std::filesystem::remove(mesher);
  EXPECT_EQ(runner.run(some_trial(), prepared(some_trial()), folder_.path()).image_size,
            (ImageSize{10, 10, 10}));
}

TEST_F(TrialTest, MissedGuaranteeIsUnmetAndNamed) {
  for (const char* exit_code : {"exit 1", "exit 0"}) {  // the record counts, whatever the exit code
    const TrialResult result = run(good_record_but(R"("facet_angle":0)", R"("facet_angle":7)") + exit_code);
    EXPECT_EQ(result.status, Status::kUnmet);
    EXPECT_EQ(result.reason, "facet_angle 7");
    EXPECT_TRUE(result.mesh);
  }
}

TEST_F(TrialTest, RunThatEndedEarlyIsUnmet) {
  const TrialResult result = run(good_record_but(R"("complete")", R"("time limit")") + "exit 1");
  EXPECT_EQ(result.status, Status::kUnmet);
  EXPECT_NE(result.reason.find("time limit"), std::string::npos);
}

TEST_F(TrialTest, ExitCodeOneAloneIsUnmet) {
  const TrialResult result = run(write_record(kGoodRecord) + "exit 1");
  EXPECT_EQ(result.status, Status::kUnmet);
  EXPECT_NE(result.reason, "");
}

TEST_F(TrialTest, FailingExitCodeKeepsWhatTheMesherSaid) {
  const TrialResult result = run(write_record(kGoodRecord) + "echo 'podm: no foreground' >&2; exit 2");
  EXPECT_EQ(result.status, Status::kFailed);
  EXPECT_EQ(result.reason, "exit code 2");
  EXPECT_EQ(result.stderr_tail, "podm: no foreground\n");
  EXPECT_FALSE(result.mesh);
}

TEST_F(TrialTest, OnlyTheEndOfLongMessagesIsKept) {
  const TrialResult result = run("i=0; while [ $i -lt 5000 ]; do echo line $i >&2; i=$((i+1)); done; exit 3");
  EXPECT_LT(result.stderr_tail.size(), 10000u);
  EXPECT_TRUE(result.stderr_tail.ends_with("line 4999\n"));
}

TEST_F(TrialTest, CrashNamesTheSignal) {
  const TrialResult result = run("kill -ABRT $$");
  EXPECT_EQ(result.status, Status::kFailed);
  EXPECT_NE(result.reason.find("signal 6"), std::string::npos) << result.reason;
}

TEST_F(TrialTest, HangIsTimedOut) {
  Trial trial = some_trial();
  trial.timeout_s = 0.3;
  const TrialResult result = run("sleep 30", trial);
  EXPECT_EQ(result.status, Status::kTimedOut);
  EXPECT_NE(result.reason, "");
}

TEST_F(TrialTest, MissingOrUnusableRecordFails) {
  const std::string unusable[] = {
      "",                                                    // no record
      write_record("not JSON"),                              //
      write_record(""),                                      //
      write_record("[1,2]"),                                 //
      write_record(kGoodRecord.substr(0, 40)),               // truncated
      good_record_but(R"("schema":1)", R"("schema":999)"),   // of another schema
      good_record_but(R"("cells":1000)", R"("cells":"x")"),  //
      good_record_but(R"("vertices":300,)", ""),             //
      good_record_but(R"("read":0.5)", R"("read":"soon")"),  //
      good_record_but(R"("refine_cells_per_second":1000.0)", R"("refine_cells_per_second":null)"),
  };
  for (const std::string& body : unusable) {
    std::filesystem::remove(folder_ / "record.jsonl");
    const TrialResult result = run(body);
    EXPECT_EQ(result.status, Status::kFailed) << body;
    EXPECT_NE(result.reason.find("record"), std::string::npos) << body;
    EXPECT_FALSE(result.mesh) << body;
  }
}

TEST_F(TrialTest, MissingMesherFails) {
  const TrialResult result =
      TrialRunner({folder_ / "absent", {}}).run(some_trial(), prepared(some_trial()), folder_.path());
  EXPECT_EQ(result.status, Status::kFailed);
  EXPECT_NE(result.reason.find(folder_ / "absent"), std::string::npos);
}

TEST_F(TrialTest, AbsentImageIsSkippedOnlyWhenItMayBeAbsent) {
  TrialRunner runner({fake_mesher(folder_, write_record(kGoodRecord)), {}});
  Trial trial = some_trial();
  trial.image = folder_ / "absent.nii";
  EXPECT_EQ(runner.why_skipped(trial), "") << "then its mesher says what is missing";
  trial.if_exists = true;
  EXPECT_EQ(runner.why_skipped(trial), trial.image + " does not exist");
  trial.image = folder_.write("present.nii", "");
  EXPECT_EQ(runner.why_skipped(trial), "");
  trial.image = "phantom:abdomen";
  EXPECT_EQ(runner.why_skipped(trial), "");
}

TEST_F(TrialTest, ImageThatCannotGrowAndCopiesWithoutProcessorsAreSkipped) {
  TrialRunner runner({fake_mesher(folder_, ""), {}});
  Trial trial = some_trial();
  trial.options["image_grows"] = true;
  EXPECT_NE(runner.why_skipped(trial).find("image.nii cannot grow"), std::string::npos);
  trial.image = "phantom:abdomen@100";
  EXPECT_EQ(runner.why_skipped(trial), "");
  trial.options["copies"] = usable_processors();
  EXPECT_EQ(runner.why_skipped(trial), "");
  trial.options["copies"] = usable_processors() + 1;
  EXPECT_NE(runner.why_skipped(trial).find("processors"), std::string::npos);
}

TEST_F(TrialTest, RadiusFoundReachesTheMesherInPlaceOfTheTarget) {
  Trial trial = some_trial();
  trial.options = {{"threads", 1}, {"target_elements", 1000}};
  Preparation preparation = prepared(trial);
  ResolvedRadius& radius = preparation.resolved.emplace();
  radius.radius_mm = 2.25;
  radius.delta_mm = 1.125;
  TrialRunner({fake_mesher(folder_, write_record(kGoodRecord)), {}}).run(trial, preparation, folder_.path());
  const std::string arguments = fmt::format(" {}", read_tail(folder_ / "arguments", 1000));
  EXPECT_NE(arguments.find(" --radius 2.25 --delta 1.125 "), std::string::npos) << arguments;
  EXPECT_EQ(arguments.find("target"), std::string::npos) << arguments;
}

TEST_F(TrialTest, ReplayDecides) {
  Trial trial = some_trial();
  trial.options["replay"] = true;
  const auto run_with_replay = [&](const std::string& body) {
    folder_.write("replay", body);
    return run(write_record(kGoodRecord), trial);
  };
  const TrialResult equal = run_with_replay("exit 0");
  EXPECT_EQ(equal.status, Status::kOk) << equal.reason;
  EXPECT_EQ(equal.replay.value().text(), "equal");
  const TrialResult differs = run_with_replay("exit 1");
  EXPECT_EQ(differs.status, Status::kUnmet);
  EXPECT_EQ(differs.replay.value().text(), "differs");
  EXPECT_EQ(differs.reason, "replay differs");
  const TrialResult failed = run_with_replay("echo 'podm: another image' >&2; exit 2");
  EXPECT_EQ(failed.status, Status::kUnmet);
  EXPECT_EQ(failed.replay.value().text(), "failed: exit code 2: podm: another image");
  trial.options["replay"] = false;
  EXPECT_FALSE(run_with_replay("exit 1").replay);
}

TEST_F(TrialTest, FidelityIsAskedForWithTheDeltaThatWasUsed) {
  Trial trial = some_trial();
  const std::string mesher = fake_mesher(folder_, good_record_but(R"("cells")", kJudged + R"("cells")"));
  const std::string verifier =
      folder_.script("podm-verify", "echo \"$@\" > \"$(dirname \"$0\")/verifier_arguments\"");
  const auto asked = [&] {
    TrialRunner({mesher, verifier}).run(trial, prepared(trial), folder_.path());
    return read_tail(folder_ / "verifier_arguments", 1000);
  };
  const auto is_asked = [&] {
    const std::string arguments = asked();
    EXPECT_NE(arguments.find("--delta 0.75"), std::string::npos) << arguments;
    return arguments.find(",size,fidelity ") != std::string::npos;
  };
  EXPECT_TRUE(is_asked());
  trial.options["fidelity"] = false;
  EXPECT_FALSE(is_asked());
  trial.tier = Tier::kKickTires;
  trial.options.erase("fidelity");
  EXPECT_FALSE(is_asked()) << "it takes too long";
  trial.options["fidelity"] = true;
  EXPECT_TRUE(is_asked());
}

TEST_F(TrialTest, MeasurementOfTheMachineIsARecordOfThisProgram) {
  Trial trial;
  trial.name = "latency";
  trial.options = {{"threads", 1}, {"measure", "memory_latency"}};
  trial.timeout_s = 20;
  const auto measure = [&](const std::string& body) {
    std::filesystem::remove(folder_ / "record.jsonl");
    const std::string bench =
        folder_.script("podm-bench", "[ \"$1 $2\" = 'latency --record' ] || exit 2\n" + body);
    return TrialRunner({.podm = folder_ / "absent", .verifier = folder_ / "absent", .bench = bench})
        .run(trial, prepared(trial), folder_.path());
  };
  const std::string good = R"({"processor":1,"pinned":true,"memory_levels":[],"latency":[]})";
  const TrialResult measured = measure("echo '" + good + "' > \"$3\"");
  EXPECT_EQ(measured.status, Status::kOk) << measured.reason;
  ASSERT_TRUE(measured.measured);
  EXPECT_EQ(measured.measured->processor, 1);
  EXPECT_FALSE(measured.counters.empty());
  for (const std::string& body : {std::string(), std::string("echo '{}' > \"$3\""),
                                  std::string("echo x > \"$3\""), "echo '" + good + "' > \"$3\"; exit 3"}) {
    const TrialResult failed = measure(body);
    EXPECT_EQ(failed.status, Status::kFailed) << body;
    EXPECT_NE(failed.reason, "") << body;
    EXPECT_FALSE(failed.measured) << body;
  }
}

TEST_F(TrialTest, StopRequestInterrupts) {
  const TrialResult result =
      TrialRunner({fake_mesher(folder_, "sleep 30"), {}})
          .run(some_trial(), prepared(some_trial()), folder_.path(), [] { return true; });
  EXPECT_EQ(result.status, Status::kInterrupted);
}

}  // namespace
}  // namespace podm::bench
