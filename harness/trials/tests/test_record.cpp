// Tests of rows, their file, the environment beside them, and the table.
#include <gtest/gtest.h>

#include <sstream>

#include "errors.h"
#include "machine/environment.h"
#include "machine/machine.h"
#include "process/sha256.h"
#include "rows/codec.h"
#include "rows/table.h"
#include "tests/fake_mesher.h"
#include "trials/record.h"

namespace podm::bench {
namespace {

struct RowTest : testing::Test {
  RowTest() {
    context.experiment = "exp";
    context.key = "some key";
    context.environment.cpu = "some cpu";
    trial.name = "some";
    trial.image = "folder/image.nii";
    trial.timeout_s = 20;
    trial.options = {{"threads", 2}};
    good.status = Status::kOk;
    good.mesh = from_json<MeshRecord>(Json::parse(kGoodRecord));
    good.preparation = prepared(trial);
    good.image_size = ImageSize{10, 10, 10};
    good.process.end = ProcessOutcome::End::kExited;
    good.process.peak_rss_bytes = 106'000;
    failed.preparation = {trial.image, "", {}};
    failed.reason = "killed by signal 6";
    failed.process.end = ProcessOutcome::End::kSignalled;
    failed.process.signal = 6;
    failed.stderr_tail = "not UTF-8: \xff\n";
  }
  Row made_of(const TrialResult& result) const { return make_row(context, trial, turn, result); }
  Json row_of(const TrialResult& result) const { return to_json(made_of(result)); }
  RowContext context;
  Trial trial;
  Turn turn{0, 3, false};
  TrialResult good, failed;
};

// The image's labels take 2000 bytes; there are 1000 cells.
TEST_F(RowTest, OverMpiTheMemoryIsOfARankAndItsShareOfTheCells) {
  context.programs.podm_mpi.emplace().sha256 = "of podm-mpi";
  EXPECT_DOUBLE_EQ(*made_of(good).process.bytes_per_cell_beyond_image, 104);
  EXPECT_FALSE(made_of(good).programs.podm_mpi) << "podm made the mesh";
  trial.options = {{"threads", 1}, {"ranks", 4}, {"carrier", "mpi"}};
  const Row over_mpi = made_of(good);
  EXPECT_DOUBLE_EQ(*over_mpi.process.bytes_per_cell_beyond_image, 416);
  EXPECT_EQ(over_mpi.basis, Basis::kMeasured);
  EXPECT_EQ(row_of(good)["programs"]["podm_mpi"]["sha256"], "of podm-mpi");
  trial.options["carrier"] = "in-process";
  const Row in_process = made_of(good);
  EXPECT_DOUBLE_EQ(*in_process.process.bytes_per_cell_beyond_image, 104);
  EXPECT_EQ(in_process.basis, Basis::kSimulated) << "its ranks' clocks are virtual";
}

TEST_F(RowTest, HoldsTheMesherRecordAndWhatTheHarnessSaw) {
  const Json row = row_of(good);
  const Json recorded = Json::parse(kGoodRecord);
  for (const auto& [key, value] : recorded.items()) {
    if (key == "input" || key == "schema") continue;  // the harness adds the size; rows have their own schema
    EXPECT_EQ(row.at(key), value) << key;
  }
  EXPECT_EQ(row.at("schema"), kRowSchema);
  EXPECT_EQ(row.at("key"), "some key");
  EXPECT_EQ(row.at("repeat"), 3);
  EXPECT_EQ(row.at("warmup"), false);
  EXPECT_EQ(row.at("asked"), trial.options);
  EXPECT_EQ(row.at("experiment"), "exp");
  EXPECT_EQ(row.at("trial"), "some");
  EXPECT_EQ(row.at("status"), "ok");
  EXPECT_EQ(row.at("input").at("name"), trial.image);
  EXPECT_EQ(row.at("input").at("sha256"), "00");
  EXPECT_EQ(row.at("input").at("size"), Json({10, 10, 10}));
  EXPECT_EQ(row.at("process").at("exit_code"), 0);
  EXPECT_TRUE(row.at("process").at("signal").is_null());
  EXPECT_EQ(row.at("environment").at("cpu"), "some cpu");
}

TEST_F(RowTest, OfAFailureSaysWhyAndOnWhat) {
  const Json row = row_of(failed);
  EXPECT_EQ(row.at("status"), "failed");
  EXPECT_EQ(row.at("reason"), failed.reason);
  EXPECT_EQ(row.at("input").at("path"), trial.image);
  EXPECT_EQ(row.at("process").at("signal"), 6);
  EXPECT_TRUE(row.at("process").at("exit_code").is_null());
  EXPECT_FALSE(row.contains("cells"));
}

TEST_F(RowTest, RecordsRadiusReplayAndCopies) {
  for (const char* key : {"resolved", "replay", "side_by_side"})
    EXPECT_TRUE(row_of(good).at(key).is_null()) << key;
  good.preparation.resolved.emplace().radius_mm = 2;
  good.replay = {Replay::End::kEqual, ""};
  good.side_by_side.emplace(1);
  EXPECT_EQ(row_of(good).at("resolved").at("radius_mm"), 2.0);
  EXPECT_EQ(row_of(good).at("replay"), "equal");
  EXPECT_EQ(row_of(good).at("side_by_side").size(), 1u);
}

TEST_F(RowTest, SecondsOfTheTableAreThoseOfTheMeshAlone) {
  const ByName<double> phases_s = {{"draw", 100}, {"read", 0.5},     {"calibrate", 100}, {"allocate", 0.25},
                                   {"refine", 1}, {"extract", 0.25}, {"measure", 100},   {"write", 100}};
  EXPECT_DOUBLE_EQ(meshing_seconds(phases_s), 2);
}

TEST_F(RowTest, MemoryPerCellLeavesOutLabels) {
  // 1000 voxels of 2 bytes, 1000 cells.
  EXPECT_DOUBLE_EQ(bytes_per_cell_beyond_image(good).value(), 104);
  EXPECT_FALSE(bytes_per_cell_beyond_image(failed).has_value());
  good.mesh->cells = 0;
  EXPECT_FALSE(bytes_per_cell_beyond_image(good).has_value());
}

TEST_F(RowTest, TableHasMediansOfTheMemoryLevels) {
  std::vector<Row> rows(3);
  const double cycles[] = {4, 9, 5};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].trial = "latency";
    rows[i].status = Status::kOk;
    auto& levels = rows[i].measured.emplace().memory_levels;
    levels.resize(2);
    levels[0].module = "L1 cache";
    levels[0].cycles = cycles[i];
    levels[1].module = "memory";
    levels[1].cycles = Unavailable{"too little"};
  }
  const std::string table = format_table({rows});
  EXPECT_NE(table.find("L1 cache 5 cycles, memory -\n"), std::string::npos) << table;
}

TEST_F(RowTest, TableIsAlignedAndListsEveryTrial) {
  good.mesh->cells = 1234567;
  const Row met = made_of(good);
  trial.name = "another-with-a-long-name";
  std::istringstream text(format_table({{met}, {made_of(failed)}, {}}));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_GT(lines.size(), 3u);
  EXPECT_EQ(lines[3].rfind("whole: ", 0), 0u) << "it says what the rates leave out";
  EXPECT_NE(lines[1].find("1 234 567"), std::string::npos);
  EXPECT_NE(lines[1].find(" 2.00 "), std::string::npos) << "seconds leave out writing";
  EXPECT_NE(lines[2].find(failed.reason), std::string::npos);
  const std::size_t last_column = lines[0].find("guarantees");
  EXPECT_EQ(lines[1].find("met"), last_column);
  EXPECT_EQ(lines[2].find("failed:"), last_column);
}

TEST_F(RowTest, TableHasFacetsAndKeptPromisesBesideTheRateOfTheWhole) {
  good.mesh->cells = 1200;
  good.mesh->boundary_facets = 345;
  good.mesh->phases_s = {{"read", 5.0}, {"surface", 1.0}, {"refine", 2.0}};
  good.mesh->verdicts = {{"structure", Proof::kPass}, {"labels", Proof::kPass}, {"size", Proof::kFail}};
  good.mesh->promises = {"structure", "size"};
  const std::string table = format_table({{made_of(good)}});
  EXPECT_NE(table.find(" 345 "), std::string::npos) << table;
  EXPECT_NE(table.find(" 400 "), std::string::npos) << "the whole counts the surface: " << table;
  EXPECT_NE(table.find(" 600 "), std::string::npos) << "refining does not: " << table;
  EXPECT_NE(table.find("2 of 3 claims proved, 1 of 2 promised ones"), std::string::npos) << table;
}

TEST_F(RowTest, TableHasMediansOfWhatIsProvedAndNoOther) {
  std::vector<Row> rows;
  for (const unsigned cells : {10u, 30u, 20u}) {
    good.mesh->cells = cells;
    rows.push_back(made_of(good));
  }
  EXPECT_NE(format_table({rows}).find(" 20 "), std::string::npos);

  good.mesh->cells = 4000;
  turn.is_warmup = true;
  rows.push_back(made_of(good));
  turn.is_warmup = false;
  good.status = Status::kUnmet;
  good.reason = "facet_angle 7";
  rows.push_back(made_of(good));
  const std::string table = format_table({rows});
  EXPECT_NE(table.find(" 20 "), std::string::npos) << table;
  EXPECT_NE(table.find("NOT met: facet_angle 7"), std::string::npos) << table;
  EXPECT_EQ(format_table({{rows.back()}}).find("4 000"), std::string::npos)
      << "no number of an unproved mesh";
}

TEST(Environment, KnowsThisMachineOrSaysWhyNot) {
  EnvironmentRecord environment = environment_of_run(this_machine().summary);
  renew(environment);
  const Json known = to_json(environment);
  for (const char* key :
       {"governor", "transparent_huge_pages", "numa_balancing", "smt", "cgroup", "kernel", "load_average",
        "memory_bytes", "compiler", "compiler_flags", "build_type", "libraries", "sources"}) {
    ASSERT_TRUE(known.contains(key)) << key;
    EXPECT_NE(known[key], "") << key;
    EXPECT_NE(known[key], Json()) << key;
  }
  EXPECT_GT(known["memory_bytes"]["total"], known["memory_bytes"]["available"]);
  EXPECT_TRUE(known["kernel"].get<std::string>().starts_with("Linux"));
}

TEST(Environment, ProgramsAreKnownByTheirBytesAndVersion) {
  const TemporaryFolder folder;
  const Programs programs{
      folder.script("podm", R"(printf 'podm 9.9\ncommit: abc\nlibraries: ITK 5: a, zlib 1\n')"),
      folder.script("podm-verify", "exit 3")};
  const Json described = to_json(describe_programs(programs));
  EXPECT_EQ(described["podm"]["version"], "podm 9.9");
  EXPECT_EQ(described["podm"]["build"], Json({{"commit", "abc"}, {"libraries", "ITK 5: a, zlib 1"}}));
  EXPECT_TRUE(described["podm_verify"]["build"].get<std::string>().starts_with("unavailable"));
  EXPECT_TRUE(described["podm_verify"]["version"].get<std::string>().starts_with("unavailable"));
  EXPECT_NE(described["podm"]["sha256"], described["podm_verify"]["sha256"]);
  EXPECT_THROW(describe_programs({folder / "absent", {}}), InputError);
}

TEST(Machine, IsTheSameEachTimeAndHasNoHostName) {
  const Machine machine = this_machine();
  EXPECT_EQ(machine.summary, this_machine().summary);
  EXPECT_GE(machine.summary.usable_processors, 1);
  EXPECT_NE(machine.topology_xml.find("<topology"), std::string::npos);
  EXPECT_EQ(machine.topology_xml.find("HostName"), std::string::npos);
}

TEST(Sha256, IsThatOfTheStandard) {  // FIPS 180-4, the one-block example
  const std::string of_abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  const TemporaryFolder folder;
  EXPECT_EQ(sha256_of("abc"), of_abc);
  EXPECT_EQ(sha256_of_file(folder.write("file", "abc")), of_abc);
  EXPECT_THROW(sha256_of_file(folder / "absent"), InputError);
  EXPECT_THROW(sha256_of_file(folder.path()), InputError);
}

}  // namespace
}  // namespace podm::bench
