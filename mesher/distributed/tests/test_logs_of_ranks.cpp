// The logs of all ranks, merged and replayed on one thread, make the mesh that the ranks made together. So
// do the logs of the ranks, each replayed by a rank. Modified logs do not.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stop_token>

#include "distributed/collective_errors.h"
#include "distributed/in_process_ranks.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/replay_on_ranks.h"
#include "podm/mesh_io.h"
#include "replay/merge_logs.h"
#include "tests/images.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

struct LoggedCase {
  std::string name;
  LabelImage image;
  double radius_mm;
  int num_ranks;
  int threads = 1;
  Space space = Space::kRas;
  std::uint64_t most_cells = 0;  // 0: no limit
  bool is_shared = true;         // true if several ranks have work
  Algorithm algorithm = Algorithm::kPodm;
};

struct LoggedRun {
  StopReason stop_reason{};
  std::vector<LogOfRank> logs;
};

// One rank may be stopped before it begins. The other ranks go on if one computes at a time, and otherwise
// hear of it.
LoggedRun run(const LoggedCase& of, int stopped_rank = -1, bool at_once = false) {
  const ScratchFolder folder;
  MeshingOptions options;
  options.sizes.radius_mm = of.radius_mm;
  options.algorithm = of.algorithm;
  options.team.threads = of.threads;
  options.team.nodes = of.algorithm == Algorithm::kPdrPodm ? 2 : 0;
  options.team.oversubscribe = true;
  options.space = of.space;
  if (of.most_cells > 0) options.limits.max_elements = of.most_cells;
  LoggedRun result;
  result.logs.resize(static_cast<std::size_t>(of.num_ranks));
  run_ranks({.num_ranks = of.num_ranks, .one_at_a_time = !at_once}, [&](Communication& ranks) {
    const std::string path = folder / (std::to_string(ranks.rank()) + ".log");
    OperationLogWriter log(path);
    MeshingOptions own = options;
    own.log = &log;
    std::stop_source stop;
    if (ranks.rank() == stopped_rank) stop.request_stop();
    const MeshingOnRanks meshing = mesh_image_on_ranks(of.image, own, ranks, {}, stop.get_token());
    log.finish({.box = meshing.report.virtual_box,
                .image_sha256 = {},
                .space = to_string(of.space),
                .mesh_sha256 = {},
                .mesh_hash = mesh_hash_text(meshing.mesh_hash),
                .rank = ranks.rank(),
                .num_ranks = ranks.size(),
                .cubes = ranks.size() > 1 ? std::optional(meshing.cubes) : std::nullopt});
    log.publish();
    result.logs[static_cast<std::size_t>(ranks.rank())] = {path, read_operation_log(path)};
    if (ranks.rank() == 0) result.stop_reason = meshing.report.stop_reason;
  });
  return result;
}

// Returns "equal", "differs", or the reason why the logs are refused.
std::string verdict(const std::vector<LogOfRank>& logs, const LoggedCase& of) try {
  const OperationLog whole = merge_logs(logs);
  const TetMesh mesh = replay_operations(of.image, whole, of.space);
  return mesh_hash_text(mesh_hash(mesh)) == whole.head.mesh_hash ? "equal" : "differs";
} catch (const InputError& error) {
  return error.what();
}

// Returns the same, for a replay on as many ranks as there are logs.
std::string verdict_on_ranks(const std::vector<LogOfRank>& logs, const LoggedCase& of) {
  std::string verdict;
  SharedValue<Isosurface> isosurface;
  run_ranks({.num_ranks = static_cast<int>(logs.size()), .one_at_a_time = true}, [&](Communication& ranks) {
    const OperationLog& own = logs[static_cast<std::size_t>(ranks.rank())].log;
    std::string text;
    try {
      const ReplayOnRanks replayed = replay_on_ranks(of.image, own, of.space, 1, ranks, isosurface);
      text = mesh_hash_text(replayed.mesh_hash) == own.head.mesh_hash ? "equal" : "differs";
    } catch (const RefusedByAll& error) {
      text = error.what();
    }
    if (ranks.rank() == 0) verdict = text;
  });
  return verdict;
}

class LogsOfRanks : public testing::TestWithParam<LoggedCase> {};

TEST_P(LogsOfRanks, ReplayToTheSameMesh) {
  const LoggedRun logged = run(GetParam());
  EXPECT_EQ(verdict(logged.logs, GetParam()), "equal");
  if (logged.logs.size() > 1) {
    EXPECT_EQ(verdict_on_ranks(logged.logs, GetParam()), "equal");
  }
  EXPECT_EQ(logged.stop_reason,
            GetParam().most_cells > 0 ? StopReason::kElementLimit : StopReason::kComplete);
  std::uint64_t num_received = 0;
  for (const LogOfRank& log : logged.logs)
    for (const LoggedOperation& entry : log.log.all.operations)
      num_received += entry.kind >= kReceivedInsertion && entry.kind < kSeed;
  EXPECT_EQ(num_received > 0, GetParam().is_shared);
}

TEST(LogsOfRanksThatStop, ReplayToTheMeshOfTheFirst) {
  const LoggedCase of{"", ball(20, 7), 1.2, 3};
  for (const int stopped_rank : {0, 1, 2}) {
    const LoggedRun logged = run(of, stopped_rank, stopped_rank == 2);
    EXPECT_EQ(logged.stop_reason, StopReason::kCancelled);
    EXPECT_EQ(verdict(logged.logs, of), "equal") << "rank " << stopped_rank;
    EXPECT_EQ(verdict_on_ranks(logged.logs, of), "equal") << "rank " << stopped_rank;
  }
}

LabelImage three_labels() {
  return make_image({24, 24, 24}, {1, 1, 1}, 3, [](int i, int j, int k) {
    if (std::hypot(i - 11.5, j - 11.5, k - 11.5) >= 10) return 0;
    return k < 9 ? 1 : i < 12 ? 2 : 3;
  });
}

std::vector<LoggedCase> logged_cases() {
  std::vector<LoggedCase> cases;
  for (const int num_ranks : {1, 2, 3, 5, 8})
    for (const int threads : {1, 2})
      cases.push_back({"labels_on_" + std::to_string(num_ranks) + "_with_" + std::to_string(threads),
                       three_labels(), 1.2, num_ranks, threads, Space::kRas, 0, num_ranks > 1});
  cases.push_back({"voxel_space", ball(24, 9), 1.2, 4, 1, Space::kVoxel});
  cases.push_back({"more_ranks_than_cells", ball(12, 4), 3, 24});
  for (const int num_ranks : {1, 2, 5})
    cases.push_back({"leaves_on_" + std::to_string(num_ranks), three_labels(), 1, num_ranks, 4, Space::kRas,
                     0, num_ranks > 1, Algorithm::kPdrPodm});
  cases.push_back({"pdr", three_labels(), 1, 3, 2, Space::kRas, 0, true, Algorithm::kPdr});
  cases.push_back(
      {"stopped_in_leaves", ball(24, 9), 1.2, 3, 4, Space::kRas, 12000, true, Algorithm::kPdrPodm});
  cases.push_back({"stopped_early", ball(24, 9), 1.2, 3, 1, Space::kRas, 1000});
  cases.push_back({"stopped_in_the_first_round", ball(24, 9), 1.2, 3, 1, Space::kRas, 12000});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Ranks, LogsOfRanks, testing::ValuesIn(logged_cases()),
                         [](const auto& test) { return test.param.name; });

// Every test spoils its own copy of the logs of one run.
class SpoiltLogs : public testing::Test {
 protected:
  static const std::vector<LogOfRank>& sound() {
    static const std::vector<LogOfRank> logs = run(of()).logs;
    return logs;
  }
  static const LoggedCase& of() {
    static const LoggedCase of{"", three_labels(), 1.2, 3};
    return of;
  }

  OperationBatch& log(std::size_t rank) { return logs_[rank].log.all; }
  std::string verdict() const { return test::verdict(logs_, of()); }
  std::string verdict_on_ranks() const { return test::verdict_on_ranks(logs_, of()); }
  void expect_refused_on_ranks(const std::string& fault) const {
    const std::string refusal = verdict_on_ranks();
    EXPECT_NE(refusal.find(fault), std::string::npos) << refusal;
  }
  // Returns some entries of this kind with isosurface points: the mesh contains all of them, because they are
  // never removed.
  std::vector<std::size_t> some_entries(std::size_t rank, std::uint32_t added_to_kind) {
    const auto kind = added_to_kind + static_cast<std::uint32_t>(VertexKind::kIsosurface);
    std::vector<std::size_t> found, some;
    for (std::size_t i = 0; i < log(rank).operations.size(); ++i)
      if (log(rank).operations[i].kind == kind) found.push_back(i);
    for (std::size_t i = 0; i < found.size(); i += 1 + found.size() / 8) some.push_back(found[i]);
    return some;
  }
  void move(std::size_t rank, std::size_t entry) {
    double& x = log(rank).operations[entry].point[entry % 3];
    x = std::nextafter(x, 0);
  }
  void leave_out(std::size_t rank, std::size_t entry) {
    OperationBatch& all = log(rank);
    const auto at = all.operations.begin() + static_cast<std::ptrdiff_t>(entry);
    std::ptrdiff_t first = 0;
    for (auto it = all.operations.begin(); it != at; ++it) first += it->num_removed;
    all.removed.erase(all.removed.begin() + first, all.removed.begin() + first + at->num_removed);
    all.operations.erase(at);
  }

  std::vector<LogOfRank> logs_ = sound();
};

TEST_F(SpoiltLogs, AreRefusedWithAReceivedVertexThatIsElsewhere) {
  int num_received = 0;
  for (std::size_t rank = 0; rank < 3; ++rank) {
    for (const std::size_t entry : some_entries(rank, kReceivedInsertion)) {
      logs_ = sound();
      move(rank, entry);
      EXPECT_EQ(verdict(), logs_[rank].path + ": " + operation_text(log(rank).operations[entry].sequence) +
                               ": receives a vertex that no rank has inserted");
      expect_refused_on_ranks("learns of it, although it does not exist");
      ++num_received;
    }
  }
  EXPECT_GT(num_received, 5);
}

TEST_F(SpoiltLogs, AreRefusedWithASeedThatARankMakesLaterOrOfAnotherKind) {
  const auto is_seed = [](const LoggedOperation& entry) { return entry.kind >= kSeed; };
  for (std::size_t rank = 0; rank < 3; ++rank) {
    logs_ = sound();
    auto& operations = log(rank).operations;
    ASSERT_GT(std::ranges::count_if(operations, is_seed), 10);
    LoggedOperation& last = *std::find_if(operations.rbegin(), operations.rend(), is_seed);
    last.sequence += std::uint64_t{1} << kBitsInStep;
    EXPECT_NE(verdict().find("a seed after the first step"), std::string::npos) << verdict();
    expect_refused_on_ranks("seeds belong to the first step");
  }
  logs_ = sound();
  for (LoggedOperation& entry : log(1).operations)
    if (is_seed(entry)) entry.kind = kSeed + static_cast<std::uint32_t>(VertexKind::kIsosurface);
  EXPECT_NE(verdict().find("a seed of another kind than another rank's"), std::string::npos) << verdict();
  expect_refused_on_ranks("as a seed of another kind");
}

TEST_F(SpoiltLogs, DoNotPassWithoutAnOperation) {
  for (std::size_t rank = 0; rank < 3; ++rank) {
    for (const std::size_t entry : some_entries(rank, 0)) {
      logs_ = sound();
      leave_out(rank, entry);
      EXPECT_NE(verdict(), "equal") << "rank " << rank << ", entry " << entry;
      EXPECT_NE(verdict_on_ranks(), "equal") << "rank " << rank << ", entry " << entry;
    }
  }
}

TEST_F(SpoiltLogs, DoNotPassWithAnOperationElsewhere) {
  for (std::size_t rank = 0; rank < 3; ++rank) {
    for (const std::size_t entry : some_entries(rank, 0)) {
      logs_ = sound();
      move(rank, entry);
      EXPECT_NE(verdict(), "equal") << "rank " << rank << ", entry " << entry;
      EXPECT_NE(verdict_on_ranks(), "equal") << "rank " << rank << ", entry " << entry;
    }
  }
}

// Returns the operations of a log with two steps swapped, sorted by their new sequence.
OperationBatch with_steps_swapped(const OperationBatch& all, std::uint64_t one, std::uint64_t other) {
  OperationBatch swapped;
  const auto take = [&](std::uint64_t step, std::uint64_t as) {
    const std::uint32_t* removed = all.removed.data();
    for (LoggedOperation entry : all.operations) {
      if (step_of(entry.sequence) == step) {
        entry.sequence += (as << kBitsInStep) - (step << kBitsInStep);
        swapped.operations.push_back(entry);
        swapped.removed.insert(swapped.removed.end(), removed, removed + entry.num_removed);
      }
      removed += entry.num_removed;
    }
  };
  const std::uint64_t last = step_of(all.operations.back().sequence);
  for (std::uint64_t step = 0; step <= last; ++step)
    take(step == one ? other : step == other ? one : step, step);
  return swapped;
}

// Rank 0 is the first in each step. In step 1 it cannot have learnt any vertex that another rank makes in
// this step, only seeds of other ranks.
TEST_F(SpoiltLogs, AreRefusedWithTwoStepsSwapped) {
  int num_swapped = 0;
  for (std::uint64_t step = 2; step <= step_of(sound()[0].log.all.operations.back().sequence); ++step) {
    logs_ = sound();
    const auto is_received_in = [step](const LoggedOperation& entry) {
      return step_of(entry.sequence) == step && entry.kind >= kReceivedInsertion && entry.kind < kSeed;
    };
    if (std::ranges::none_of(log(0).operations, is_received_in)) continue;
    log(0) = with_steps_swapped(log(0), 1, step);
    const std::string fault = verdict();
    EXPECT_NE(fault.find("0.log: operation "), std::string::npos) << fault;
    EXPECT_NE(fault.find(" of step 1: receives a vertex that no rank has inserted"), std::string::npos)
        << fault;
    EXPECT_NE(verdict_on_ranks(), "equal") << "steps 1 and " << step;
    ++num_swapped;
  }
  EXPECT_GT(num_swapped, 0);
}

// A piece that lacks cubes, or has too many, would miss cells or count them twice.
TEST_F(SpoiltLogs, AreRefusedIfBlocksDoNotTileSpaceOrTooMuchIsKnown) {
  const auto cubes = [this](std::size_t rank) -> CubesOfRank& { return *logs_[rank].log.head.cubes; };
  const auto with = [](std::vector<CubesOfRank::Run> runs, std::uint32_t cube) {
    runs.push_back({cube, cube});
    return runs;
  };
  const std::uint32_t cube = cubes(1).block.front()[0];
  ++cubes(1).block.front()[0];
  expect_refused_on_ranks("is in no rank's block");
  logs_ = sound();
  cubes(2).block = with(cubes(2).block, cube);
  expect_refused_on_ranks("is in the blocks of ranks");
  logs_ = sound();
  cubes(0).known = {{0, cubes(0).block.back()[1]}};
  for (std::size_t rank = 1; rank < 3; ++rank)
    for (const auto& run : cubes(rank).block)
      if (run[1] > cubes(0).known.front()[1]) cubes(0).known.push_back(run);
  expect_refused_on_ranks("which knows its cube, lacks it");
  logs_ = sound();
  cubes(0).known = cubes(0).block;
  expect_refused_on_ranks("may not be cells of the whole mesh");
  logs_ = sound();
  logs_[1].log.head.cubes.reset();
  EXPECT_NE(verdict_on_ranks(), "equal");
}

TEST_F(SpoiltLogs, EndWithAVerdictWhateverIsInThem) {
  std::mt19937 random(3);
  int num_equal = 0, num_equal_seeds = 0, num_equal_on_ranks = 0;
  for (int round = 0; round < 60; ++round) {
    logs_ = sound();
    OperationBatch& all = log(random() % 3);
    LoggedOperation& entry = all.operations[random() % all.operations.size()];
    const bool is_seed = (entry.kind & kSeed) != 0;
    switch (random() % 4) {
      case 0:
        entry.vertex = static_cast<std::uint32_t>(random() % 100);
        break;
      case 1:
        entry.kind ^= 1u << random() % 11;
        break;
      case 2:
        entry.point[random() % 3] += 0.5;
        break;
      default:
        all.removed[random() % all.removed.size()] = static_cast<std::uint32_t>(random() % 1000);
    }
    (is_seed ? num_equal_seeds : num_equal) += verdict() == "equal";
    num_equal_on_ranks += !is_seed && verdict_on_ranks() == "equal";
  }
  EXPECT_LT(num_equal, 6);  // a vertex may by chance have the number of another vertex in a log
  EXPECT_LT(num_equal_on_ranks, 6);
  EXPECT_LT(num_equal_seeds, 20);  // a seed outside the object is in no cell of the mesh
}

}  // namespace
}  // namespace podm::test
