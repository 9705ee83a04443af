// The public API: guarantees on every image, frames, sizes, limits and refusals.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "image/foreground.h"
#include "image/working_frame.h"
#include "podm/mesh_image.h"
#include "podm/operation_log.h"
#include "tests/images.h"

namespace podm::test {
namespace {

double volume_of(const TetMesh& mesh, std::size_t c) {
  std::array<std::array<double, 3>, 4> p;
  for (unsigned i = 0; i < 4; ++i) p[i] = mesh.vertices[mesh.cells[c][i]];
  std::array<std::array<double, 3>, 3> e;
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned a = 0; a < 3; ++a) e[i][a] = p[i + 1][a] - p[0][a];
  }
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
          e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
         6;
}

double total_volume(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) sum += volume_of(mesh, c);
  return sum;
}

MeshingOptions radius(double mm) { return {.sizes = {.radius_mm = mm}, .team = {.threads = 1}}; }

class MeshImage : public testing::TestWithParam<NamedImage> {};

TEST_P(MeshImage, MeetsEveryGuarantee) {
  const LabelImage image = GetParam().make();
  const MeshingResult result = mesh_image(image, radius(1));
  EXPECT_EQ(result.report.stop_reason, StopReason::kComplete);
  EXPECT_TRUE(result.report.guarantees.all_met());
  EXPECT_EQ(result.report.counters.rejected, 0u);
  EXPECT_FALSE(result.mesh.cells.empty());
  for (std::size_t c = 0; c < result.mesh.cells.size(); ++c) ASSERT_GT(volume_of(result.mesh, c), 0);
}

TEST_P(MeshImage, BoundsEveryLabelByClosedSurfaces) {
  const MeshingResult result = mesh_image(GetParam().make(), radius(2));
  // Around each label every directed facet edge occurs as often as its reverse.
  std::map<LabelIndex, std::map<std::pair<std::uint32_t, std::uint32_t>, int>> edges;
  for (std::size_t f = 0; f < result.mesh.facets.size(); ++f) {
    const auto& [low, high] = result.mesh.facet_labels[f];
    EXPECT_LT(low, high);
    for (unsigned i = 0; i < 3; ++i) {
      const auto a = result.mesh.facets[f][i], b = result.mesh.facets[f][(i + 1) % 3];
      const int outwards = a < b ? 1 : -1;  // as seen from the second label
      edges[high][{std::min(a, b), std::max(a, b)}] += outwards;
      edges[low][{std::min(a, b), std::max(a, b)}] -= outwards;
    }
  }
  for (const auto& [label, directed] : edges) {
    for (const auto& [edge, sum] : directed) ASSERT_EQ(sum, 0) << "label index " << label;
  }
}

INSTANTIATE_TEST_SUITE_P(Images, MeshImage, testing::ValuesIn(images()),
                         [](const auto& image) { return std::string(image.param.name); });

TEST(MeshImageGeometry, BallHasItsVolume) {
  const MeshingResult result = mesh_image(ball(40, 15), radius(2));
  EXPECT_NEAR(total_volume(result.mesh), 4.0 / 3 * std::numbers::pi * 15 * 15 * 15, 150);
}

class MeshImageFrames : public testing::TestWithParam<NamedAffine> {};

TEST_P(MeshImageFrames, AgreeAndStayPositive) {
  LabelImage image = ball(16, 6);
  image.voxel_to_ras = GetParam().affine;
  std::map<Space, MeshingResult> results;
  for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel}) {
    MeshingOptions options = radius(2);
    options.space = space;
    results[space] = mesh_image(image, options);
    EXPECT_EQ(results[space].mesh.space, space);
    for (std::size_t c = 0; c < results[space].mesh.cells.size(); ++c) {
      ASSERT_GT(volume_of(results[space].mesh, c), 0);
    }
  }
  const auto& ras = results[Space::kRas].mesh.vertices;
  const auto& lps = results[Space::kLps].mesh.vertices;
  const auto& voxel = results[Space::kVoxel].mesh.vertices;
  ASSERT_EQ(ras.size(), voxel.size());
  for (std::size_t v = 0; v < ras.size(); ++v) {
    EXPECT_EQ(lps[v], (std::array<double, 3>{-ras[v][0], -ras[v][1], ras[v][2]}));
    const auto mapped = map(image.voxel_to_ras, voxel[v]);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(ras[v][axis], mapped[axis], 1e-12);
  }
}

TEST_P(MeshImageFrames, BoundsHoldTheObject) {
  LabelImage image = ball(16, 6);
  image.voxel_to_ras = GetParam().affine;
  const Box bounds = foreground_bounds(image);
  const Affine to_working = voxels_to_working(image);
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i)
        if (image.voxels[image.index(i, j, k)] != kBackground) {
          const Point voxel{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          for (const Vector& aside :
               {Vector{1, 0, 0}, Vector{-1, 1, 0}, Vector{0, -1, 1}, Vector{0, 0, -1}}) {
            EXPECT_TRUE(is_in(bounds, map(to_working, voxel + 0.999 * aside)));
          }
        }
}

INSTANTIATE_TEST_SUITE_P(Affines, MeshImageFrames, testing::ValuesIn(affines()),
                         [](const auto& affine) { return std::string(affine.param.name); });

TEST(MeshImageSizes, LabelsHaveTheirOwnRadius) {
  const LabelImage image =
      make_image({20, 20, 20}, {1, 1, 1}, 2, [](int i, int, int) { return i < 10 ? 1 : 2; });
  MeshingOptions options = radius(4);
  options.sizes.delta_mm = 1.2;
  options.sizes.radius_of_mm[20] = 0.8;
  const MeshingResult result = mesh_image(image, options);
  EXPECT_TRUE(result.report.guarantees.all_met());
  EXPECT_GT(result.report.cells_of_label.at(20), 3 * result.report.cells_of_label.at(10));
}

TEST(MeshImagePhases, EachAlgorithmReportsItsOwn) {
  for (const int threads : {1, 3}) {
    for (const Executor executor : {Executor::kThreads, Executor::kVirtual}) {
      MeshingOptions options = radius(2);
      options.team.threads = threads;
      options.team.oversubscribe = true;
      options.team.executor = executor;
      const auto phases = [&](Algorithm algorithm) {
        options.algorithm = algorithm;
        std::set<std::string> names;
        for (const auto& [phase, seconds] : mesh_image(ball(24, 9), options).report.phases_s) {
          EXPECT_GE(seconds, 0) << phase;
          names.insert(phase);
        }
        return names;
      };
      using Names = std::set<std::string>;
      EXPECT_EQ(phases(Algorithm::kPodm), (Names{"transform", "allocate", "refine", "extract", "measure"}));
      EXPECT_EQ(phases(Algorithm::kPdrPodm), (Names{"transform", "allocate", "initial", "octree", "refine",
                                                    "closing", "extract", "measure"}));
    }
  }
}

TEST(MeshImagePhases, AreReportedForARunThatWasStoppedBeforeItRefined) {
  std::stop_source stop;
  stop.request_stop();
  for (const Algorithm algorithm : {Algorithm::kPodm, Algorithm::kPdr, Algorithm::kPdrPodm}) {
    MeshingOptions options = radius(2);
    options.algorithm = algorithm;
    const MeshingReport report = mesh_image(ball(24, 9), options, {}, stop.get_token()).report;
    EXPECT_EQ(report.stop_reason, StopReason::kCancelled);
    for (const char* phase : {"transform", "allocate", "refine", "extract", "measure"})
      EXPECT_TRUE(report.phases_s.contains(phase)) << phase;
  }
}

TEST(MeshImageRuns, AreRepeatable) {
  const LabelImage image = ball(24, 9);
  const MeshingResult first = mesh_image(image, radius(1.5)), second = mesh_image(image, radius(1.5));
  EXPECT_EQ(first.mesh.cells, second.mesh.cells);
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
}

TEST(MeshImageRuns, LimitsAndCancellationLeaveAMeshThatSaysSo) {
  const LabelImage image = ball(40, 15);
  MeshingOptions elements = radius(0.3), time = radius(0.3), memory = radius(0.3);
  elements.limits.max_elements = 20000;
  time.limits.max_seconds = 0.2;
  memory.limits.max_memory_bytes = 1 << 20;
  EXPECT_EQ(mesh_image(image, elements).report.stop_reason, StopReason::kElementLimit);
  EXPECT_EQ(mesh_image(image, time).report.stop_reason, StopReason::kTimeLimit);
  EXPECT_EQ(mesh_image(image, memory).report.stop_reason, StopReason::kMemoryLimit);
  std::stop_source stop;
  const ProgressCallback cancel = [&](const Progress& progress) {
    if (progress.phase == "refine") stop.request_stop();
  };
  const MeshingResult cancelled = mesh_image(image, radius(0.3), cancel, stop.get_token());
  EXPECT_EQ(cancelled.report.stop_reason, StopReason::kCancelled);
  for (std::size_t c = 0; c < cancelled.mesh.cells.size(); ++c) ASSERT_GT(volume_of(cancelled.mesh, c), 0);
}

// The mesh is so small that the limit is passed between two checks of a worker.
TEST(MeshImageRuns, ALimitThatASmallMeshPassesIsReported) {
  for (const int threads : {1, 3}) {
    MeshingOptions options = radius(9);
    options.team = {.threads = threads, .oversubscribe = true};
    options.limits.max_elements = 7;
    EXPECT_EQ(mesh_image(ball(16, 6), options).report.stop_reason, StopReason::kElementLimit) << threads;
  }
}

// An octree with leaves of this size is refused, but only when the run reaches it.
TEST(MeshImageRuns, ALimitPassedByTheInitialMeshIsNoFaultOfLeaves) {
  MeshingOptions options = radius(4e-7);
  options.sizes.delta_mm = 1;
  options.algorithm = Algorithm::kPdr;
  options.limits.max_elements = 3000;
  const MeshingReport report = mesh_image(ball(16, 6), options).report;
  EXPECT_EQ(report.stop_reason, StopReason::kElementLimit);
  EXPECT_FALSE(report.phases_s.contains("octree"));
  EXPECT_TRUE(report.phases_s.contains("refine"));
}

TEST(MeshImageRuns, ScheduleListsLeavesByTheirEnds) {
  MeshingOptions options = radius(0.5);
  options.algorithm = Algorithm::kPdr;
  options.team = {.threads = 6, .oversubscribe = true};
  options.leaves.with_schedule = true;
  const auto schedule = mesh_image(ball(24, 9), options).report.schedule;
  ASSERT_TRUE(schedule);
  EXPECT_GT(schedule->activations.size(), 10u);
  double last_s = 0;
  for (const LeafSchedule::Activation& activation : schedule->activations) {
    EXPECT_LE(activation.begin_s, activation.end_s);
    EXPECT_LE(last_s, activation.end_s);
    last_s = activation.end_s;
  }
}

TEST(MeshImageRefusals, BadOptionsAndEmptyImages) {
  const LabelImage image = ball(10, 3);
  for (const double bad :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(mesh_image(image, radius(bad)), InputError);
    MeshingOptions delta = radius(1);
    delta.sizes.delta_mm = bad;
    EXPECT_THROW(mesh_image(image, delta), InputError);
    MeshingOptions label = radius(1);
    label.sizes.radius_of_mm[10] = bad;
    EXPECT_THROW(mesh_image(image, label), InputError);
    MeshingOptions tolerance = radius(1);
    tolerance.sizes.target_tolerance_percent = bad;
    EXPECT_THROW(mesh_image(image, tolerance), InputError);
  }
  MeshingOptions anything = radius(1);
  anything.sizes.target_tolerance_percent = 101;
  EXPECT_THROW(mesh_image(image, anything), InputError);
  for (const int meshes : {-1, 0, 101}) {
    MeshingOptions never = radius(1);
    never.sizes.target_meshes = meshes;
    EXPECT_THROW(mesh_image(image, never), InputError) << meshes;
  }
  LabelImage without_voxels = image;
  without_voxels.voxels.clear();
  for (const LabelImage& empty : {LabelImage{}, without_voxels}) {
    EXPECT_THROW(mesh_image(empty, radius(1)), InputError);
    EXPECT_THROW(estimate(empty, radius(1)), InputError);
    EXPECT_THROW(replay_operations(empty, OperationLog{}, Space::kRas), InputError);
  }
  MeshingOptions absent = radius(1);
  absent.sizes.radius_of_mm[77] = 1;
  EXPECT_THROW(mesh_image(image, absent), InputError);
  MeshingOptions both = radius(1);
  both.sizes.target_elements = 1000;
  EXPECT_THROW(mesh_image(image, both), InputError);
  const LabelImage empty = make_image({4, 4, 4}, {1, 1, 1}, 1, [](int, int, int) { return 0; });
  EXPECT_THROW(mesh_image(empty, radius(1)), InputError);
}

TEST(MeshImageRefusals, AffinesThatAreNotOfTheSpacing) {
  LabelImage image = ball(10, 3);
  for (const Affine& bad :
       {Affine{}, Affine{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0}, Affine{1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0},
        Affine{std::nan(""), 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}) {
    image.voxel_to_ras = bad;
    EXPECT_THROW(mesh_image(image, radius(1)), InputError);
  }
}

}  // namespace
}  // namespace podm::test
