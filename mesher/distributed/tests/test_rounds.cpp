// The ranks together make one Delaunay mesh to which no rule applies. Each rank has its part of the mesh.
#include "delaunay/tests/validity.h"
#include "distributed/rounds.h"

#include <gtest/gtest.h>

#include <mutex>
#include <optional>

#include "delaunay/walk.h"
#include "distributed/in_process_ranks.h"
#include "distributed/pieces.h"
#include "image/foreground.h"
#include "podm/mesh_io.h"
#include "run/measure_quality.h"
#include "sizing/default_sizes.h"
#include "tests/images.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

struct Case {
  std::string name;
  LabelImage image;
  double radius_mm, delta_mm;
  int num_ranks;
  int threads = 1;
  double initial_ratio = 4;
  std::uint64_t cut_seed = 0;
  bool at_once = false;  // ranks compute at the same time
  Algorithm algorithm = Algorithm::kPodm;
  int nodes = 1;  // computing nodes per rank
  double leaf_size_mm = 0;
  std::optional<int> limited_rank = {};  // the only rank with limits; unset: all have them
};

class Ranks {
 public:
  explicit Ranks(const Case& of, std::uint64_t seed = 1, const Limits& limits = {},
                 const CheckpointOptions& checkpoint_options = {})
      : case_(of), isosurface_(of.image, 1) {
    refined.resize(static_cast<std::size_t>(of.num_ranks));
    pieces.resize(refined.size());
    sizes_.radius_mm = of.radius_mm;
    sizes_.delta_mm = of.delta_mm;
    problem.emplace(Problem{.isosurface = isosurface_,
                            .object = foreground_bounds(of.image),
                            .delta_mm = delta_mm_for(of.image, sizes_, nullptr),
                            .sizes = size_field(of.image, sizes_),
                            .cell_capacity = 1 << 22});
    run_ranks(
        {.num_ranks = of.num_ranks, .one_at_a_time = !of.at_once, .seed = seed}, [&](Communication& ranks) {
          const Team team{.coordination = {.num_workers = of.threads},
                          .num_nodes = of.nodes,
                          .initial_workers = of.threads};
          const bool is_limited = of.limited_rank.value_or(ranks.rank()) == ranks.rank();
          EndOnAllRanks end(ranks, {});
          StopControl stop(is_limited ? limits : Limits{}, end.token(), [&](std::uint64_t) { end.hear(); });
          const auto rank = static_cast<std::size_t>(ranks.rank());
          std::optional<Checkpoints> checkpoints;
          if (!checkpoint_options.folder.empty())
            checkpoints.emplace(checkpoint_options, std::vector<Fact>{}, ranks);
          refined[rank].emplace(
              podm_distributed(*problem, team,
                               {of.initial_ratio, of.cut_seed, of.algorithm, of.leaf_size_mm,
                                checkpoints ? &*checkpoints : nullptr, &end},
                               ranks, stop));
        });
  }

  /// Returns a new mesh of all vertices that ranks have in their blocks.
  std::unique_ptr<Mesh> whole() const {
    auto mesh = std::make_unique<Mesh>(refined[0]->refinement.mesh->box(), 1 << 22);
    Pool pool(*mesh);
    Operation<NoLocks> operation(*mesh, pool, 0);
    CellId near = 0;
    for (int rank = 0; rank < case_.num_ranks; ++rank) {
      const Mesh& part = *refined[static_cast<std::size_t>(rank)]->refinement.mesh;
      for (VertexId v = 0; v < part.vertex_bound(); ++v) {
        const Vertex& vertex = part.vertex(v);
        if (vertex.kind == VertexKind::kUnused || vertex.kind == VertexKind::kBox) continue;
        if (rank_of(vertex.point) != rank) continue;
        near = cell_with(*mesh, vertex.point, near);
        EXPECT_EQ(operation.plan_insertion(vertex.point, near), StepResult::kDone);
        EXPECT_EQ(operation.commit_insertion(vertex.point, vertex.kind, 0), StepResult::kDone);
        near = operation.created().front();
      }
    }
    return mesh;
  }

  int rank_of(const Point& p) const { return refined[0]->blocks.of(refined[0]->grid.place_of(p)); }

  /// Returns the cells with a vertex in the rank's block, other than a corner of the virtual box, and their
  /// neighbours, by their points.
  std::vector<std::array<Point, 4>> cells_at_block(const Mesh& mesh, int rank) const {
    const auto is_at_block = [&](const Cell& cell) {
      return std::any_of(cell.vertices.begin(), cell.vertices.end(), [&](VertexId v) {
        return mesh.vertex(v).kind != VertexKind::kBox && rank_of(mesh.point(v)) == rank;
      });
    };
    std::vector<std::array<Point, 4>> cells;
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      const Cell& cell = mesh.cell(c);
      if (!cell.is_alive()) continue;
      if (!is_at_block(cell) && std::none_of(cell.mirrors.begin(), cell.mirrors.end(), [&](FacetId mirror) {
            return mirror != kNoFacet && is_at_block(mesh.cell(cell_of(mirror)));
          }))
        continue;
      std::array<Point, 4>& points = cells.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) points[i] = mesh.point(cell.vertices[i]);
      std::sort(points.begin(), points.end(), lexicographically_less);
    }
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), lexicographically_less);
    });
    return cells;
  }

  /// Returns the number of insertions that rules still require in a mesh.
  std::uint64_t insertions_left(Mesh& mesh) const {
    const TwoLevels levels = two_levels(*problem, case_.initial_ratio);
    Pool pool(mesh);
    Worker<NoLocks> worker(mesh, isosurface_, levels.final, 0, pool);
    for (CellId c = 0; c < mesh.cell_bound(); ++c)
      if (mesh.cell(c).is_alive()) worker.give(c);
    std::uint64_t insertions = 0;
    while (worker.has_work()) insertions += worker.attempt() == Outcome::kCommitted;
    return insertions;
  }

  std::vector<std::optional<DistributedRefinement>> refined;  // by rank
  std::vector<MeshPiece> pieces;
  std::optional<Problem> problem;

 private:
  const Case& case_;
  Isosurface isosurface_;
  SizeOptions sizes_;
};

// Expects that the ranks together have one mesh to which no rule applies.
void expect_done(const Ranks& ranks, int num_ranks) {
  const std::unique_ptr<Mesh> whole = ranks.whole();
  for (int rank = 0; rank < num_ranks; ++rank) {
    const Mesh& part = *ranks.refined[static_cast<std::size_t>(rank)]->refinement.mesh;
    EXPECT_TRUE(is_valid(part));
    EXPECT_EQ(ranks.cells_at_block(part, rank), ranks.cells_at_block(*whole, rank)) << "rank " << rank;
  }
  EXPECT_EQ(ranks.insertions_left(*whole), 0u);
}

class Rounds : public testing::TestWithParam<Case> {};

TEST_P(Rounds, EveryRankHasItsPartOfOneMeshThatIsDone) {
  Ranks ranks(GetParam());
  expect_done(ranks, GetParam().num_ranks);
}

// Returns a case with 2 computing nodes of 2 cores each, or for kPdr with one node per core. Leaves are
// short, so that some operations need more than their regions.
Case by_leaves(const std::string& name, int num_ranks, Algorithm algorithm = Algorithm::kPdrPodm) {
  Case of{name, ball(24, 9), 1.2, 0, num_ranks, 4, 2};
  of.algorithm = algorithm;
  of.nodes = algorithm == Algorithm::kPdr ? of.threads : 2;
  of.leaf_size_mm = 4;
  return of;
}

TEST(RoundsByLeaves, RefineMostInLeavesOfOneOctree) {
  for (const Algorithm algorithm : {Algorithm::kPdr, Algorithm::kPdrPodm}) {
    const Case of = by_leaves("", 2, algorithm);
    const Ranks ranks(of);
    std::uint64_t in_leaves = 0, insertions = 0;
    for (const auto& refined : ranks.refined) {
      const RoundReport& first = refined->rounds.front();
      in_leaves += first.in_leaves;
      insertions += first.insertions;
      EXPECT_EQ(refined->refinement.num_leaves, ranks.refined[0]->refinement.num_leaves);
      EXPECT_GT(refined->refinement.num_leaves, 50u);
    }
    EXPECT_GT(in_leaves, insertions / 2);
  }
}

TEST(RoundsThatStop, LeaveAMeshAllTheSame) {
  const Case of{"", ball(24, 9), 1.2, 0, 3};
  for (const std::uint64_t most_cells : {1000u, 4000u}) {  // of coarser seeds, and in the first round
    Ranks ranks(of, 1, {.max_elements = most_cells});
    std::uint64_t insertions = 0;
    for (int rank = 0; rank < 3; ++rank) {
      const auto& refined = *ranks.refined[static_cast<std::size_t>(rank)];
      EXPECT_TRUE(is_valid(*refined.refinement.mesh));
      insertions += refined.refinement.counters.cells_created;
    }
    const std::unique_ptr<Mesh> whole = ranks.whole();
    EXPECT_TRUE(is_valid(*whole));
    EXPECT_GT(whole->num_cells(), 6u);
    EXPECT_GT(insertions, 0u);
    EXPECT_GT(ranks.insertions_left(*whole), 0u);
  }
}

// Without the limit the first round takes seconds.
TEST(RoundsThatStop, EndOnAllRanksAtALimitOfOne) {
  for (const int threads : {1, 2}) {
    Case of{"", ball(24, 9), 0.22, 0, 3, threads};
    of.at_once = true;
    of.limited_rank = 1;
    const Ranks ranks(of, 1, {.max_seconds = 0.2});
    for (std::size_t rank = 0; rank < ranks.refined.size(); ++rank) {
      const DistributedRefinement& refined = *ranks.refined[rank];
      EXPECT_EQ(refined.refinement.stop_reason, rank == 1 ? StopReason::kTimeLimit : StopReason::kCancelled);
      EXPECT_EQ(refined.rounds.size(), 1u);
    }
  }
}

TEST(ResumedRounds, EndTheMeshOfACheckpointOnAnyNumberOfRanks) {
  const ScratchFolder folder;
  for (const std::uint64_t most_cells : {1000u, 6000u, 0u}) {  // in seeding, in the first round, and of all
    const CheckpointOptions first{.folder = folder / std::to_string(most_cells), .seconds = 0};
    CheckpointOptions resumed = first;
    resumed.is_resumed = true;
    Case of{"", ball(24, 9), 1.2, 0, 3};
    { const Ranks begun(of, 1, {.max_elements = most_cells}, first); }
    for (const int num_ranks : {1, 2, 3, 7}) {
      of.num_ranks = num_ranks;
      of.threads = 1 + num_ranks % 2;
      const Ranks ranks(of, 1, {}, resumed);
      expect_done(ranks, num_ranks);
    }
  }
}

TEST(ResumedRounds, RefineNoMeshThatIsDone) {
  const ScratchFolder folder;
  const Case of{"", ball(24, 9), 1.2, 0, 3}, of_more{"", ball(24, 9), 1.2, 0, 4};
  const Ranks begun(of, 1, {}, {.folder = folder / "a", .seconds = 0});
  const Ranks resumed(of_more, 1, {}, {.folder = folder / "a", .seconds = 0, .is_resumed = true});
  EXPECT_EQ(begun.whole()->num_cells(), resumed.whole()->num_cells());
  for (const auto& refined : resumed.refined) EXPECT_EQ(refined->refinement.counters.cells_created, 0u);
}

TEST(ResumedRounds, HaveFewVerticesFarFromTheirBlocks) {
  const ScratchFolder folder;
  Case of{"", ball(24, 9), 0.5, 0, 2};
  { const Ranks begun(of, 1, {}, {.folder = folder / "a", .seconds = 0}); }
  of.num_ranks = 64;
  const Ranks resumed(of, 1, {}, {.folder = folder / "a", .seconds = 0, .is_resumed = true});
  const VertexId num_vertices = resumed.whole()->vertex_bound();
  for (const auto& refined : resumed.refined) EXPECT_LT(refined->seeds, num_vertices / 5);
}

TEST(DrawnBlocks, TileSpaceAndAreThinNowAndThen) {
  const CubeGrid grid({{0, 0, 0}, {9.5, 7.5, 3.5}}, 1);
  int num_thin = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const int num_blocks = 2 + static_cast<int>(seed) % 8;
    const Blocks blocks(grid, seed, num_blocks);
    const Blocks same(grid, seed, num_blocks);
    for (int block = 0; block < num_blocks; ++block) {
      CubePlace low = grid.size(), high{-1, -1, -1};
      CubeId num_cubes = 0;
      for (CubeId cube = 0; cube < grid.num_cubes(); ++cube) {
        const CubePlace at = grid.place_of(cube);
        ASSERT_EQ(blocks.of(at), same.of(at));
        ASSERT_EQ(blocks.of(at) == block, blocks.range_of(block).has(at));
        if (blocks.of(at) != block) continue;
        ++num_cubes;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], at[axis]);
          high[axis] = std::max(high[axis], at[axis]);
        }
      }
      ASSERT_GT(num_cubes, 0u) << "block " << block << " of seed " << seed;
      for (std::size_t axis = 0; axis < 3; ++axis)
        num_thin += low[axis] == high[axis] && low[axis] > 0 && high[axis] + 1 < grid.size()[axis];
    }
  }
  EXPECT_GT(num_thin, 10);
}

std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const int num_ranks : {1, 2, 3, 5, 8})
    cases.push_back({"ball_on_" + std::to_string(num_ranks), ball(24, 9), 1.2, 0, num_ranks});
  cases.push_back({"surface_alone", image_named("three_labels_meeting"), 0, 1, 4});
  cases.push_back({"three_labels", image_named("three_labels_meeting"), 1, 0, 6});
  cases.push_back({"threads", image_named("three_labels_meeting"), 1, 0, 3, 2});
  cases.push_back({"anisotropic", image_named("anisotropic_ball"), 0.9, 0, 4, 1, 2});
  cases.push_back({"no_coarser_leaves", ball(24, 9), 1.2, 0, 4, 1, 1});
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u})
    cases.push_back({"cuts_drawn_by_" + std::to_string(seed), ball(24, 9), 1.2, 0, 3 + static_cast<int>(seed),
                     1, seed % 2 == 0 ? 1.0 : 2.0, seed});
  cases.push_back({"drawn_cuts_and_threads", image_named("three_labels_meeting"), 1, 0, 5, 2, 1.5, 7});
  cases.push_back({"threads_at_once", ball(24, 9), 1.2, 0, 3, 2, 2, 0, true});
  cases.push_back({"drawn_cuts_at_once", image_named("three_labels_meeting"), 1, 0, 4, 2, 1.5, 8, true});
  cases.push_back({"more_ranks_than_cells", ball(12, 4), 6, 3, 24});
  for (const int num_ranks : {2, 3, 5})
    cases.push_back(by_leaves("leaves_on_" + std::to_string(num_ranks), num_ranks));
  cases.push_back(by_leaves("pdr", 4, Algorithm::kPdr));
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    cases.push_back(
        by_leaves("leaves_and_cuts_drawn_by_" + std::to_string(seed), 1 + static_cast<int>(seed)));
    cases.back().cut_seed = seed;
    cases.back().image = image_named("three_labels_meeting");
    cases.back().at_once = seed % 2 == 0;
  }
  cases.push_back(by_leaves("leaves_longer_than_blocks", 5));
  cases.back().leaf_size_mm = 30;
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Ranks, Rounds, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace podm::test
