// Meshes that keep thin layers have the topology of their images, for every algorithm.
#include <gtest/gtest.h>

#include <random>

#include "podm/mesh_image.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm::test {
namespace {

MeshingOptions keeping(double radius_mm, double delta_mm) {
  MeshingOptions options;
  options.sizes.radius_mm = radius_mm;
  options.sizes.delta_mm = delta_mm;
  options.sizes.thin = Thin::kKeep;
  options.team.threads = 1;
  return options;
}

int cube_radius(int i, int j, int k, int center) {
  return std::max({std::abs(i - center), std::abs(j - center), std::abs(k - center)});
}

// Shells of 1, 2 and 3 voxels, one in another.
LabelImage shells() {
  return make_image({26, 26, 26}, {1, 1, 1}, 3, [](int i, int j, int k) {
    const int r = cube_radius(i, j, k, 13);
    return r == 11 ? 1 : r == 8 || r == 7 ? 2 : r <= 4 && r >= 2 ? 3 : 0;
  });
}

LabelImage plate_with_holes() {
  return make_image({24, 18, 9}, {1, 1, 1.5}, 1, [](int i, int j, int k) {
    const bool is_hole = (i % 6 == 4 || i % 6 == 5) && (j % 6 == 3 || j % 6 == 4) && i < 20 && j < 14;
    return k == 4 && i > 1 && i < 22 && j > 0 && j < 17 && !is_hole;
  });
}

LabelImage ring() {
  return make_image({20, 20, 7}, {1, 1, 1}, 1, [](int i, int j, int k) {
    const int r = std::max(std::abs(i - 10), std::abs(j - 10));
    return k == 3 && r == 6;
  });
}

// A membrane of one voxel between two labels, and a gap of one voxel.
LabelImage membrane() {
  return make_image({22, 20, 20}, {1, 1, 1}, 3, [](int i, int j, int k) {
    if (cube_radius(i, j, k, 10) > 8) return 0;
    return i == 10 ? 3 : i == 14 ? 0 : i < 10 ? 1 : 2;
  });
}

LabelImage blobs(unsigned seed) {
  std::mt19937 random(seed);
  LabelImage image = make_image({16, 15, 14}, {1, 1, 1}, 2, [](int, int, int) { return 0; });
  for (int n = 0; n < 12; ++n) {
    const auto any = [&](int size) {
      return 2 + static_cast<int>(random() % static_cast<unsigned>(size - 5));
    };
    const int i = any(16), j = any(15), k = any(14), a = static_cast<int>(random() % 3),
              b = static_cast<int>(random() % 3), c = static_cast<int>(random() % 3);
    const auto label = static_cast<LabelIndex>(1 + random() % 2);
    for (int z = k; z <= std::min(k + c, 12); ++z)
      for (int y = j; y <= std::min(j + b, 13); ++y)
        for (int x = i; x <= std::min(i + a, 14); ++x) image.voxels[image.index(x, y, z)] = label;
  }
  return image;
}

void expect_kept(const LabelImage& image, const MeshingOptions& options) {
  const MeshingResult made = mesh_image(image, options);
  ASSERT_TRUE(made.report.topology);
  for (const TopologyReport::Difference& each : made.report.topology->differences)
    ADD_FAILURE() << to_string(each.kind) << " label " << each.label.value << " at " << each.voxel[0] << " "
                  << each.voxel[1] << " " << each.voxel[2];
  EXPECT_TRUE(made.report.guarantees.all_met());
  ASSERT_TRUE(made.mesh.topology_differences);
  EXPECT_EQ(made.mesh.topology_differences->size(), made.report.topology->differences.size());
}

TEST(ThinLayersOfMeshes, ShellsPlatesRingsAndMembranesAreKept) {
  expect_kept(shells(), keeping(6, 3));
  expect_kept(plate_with_holes(), keeping(6, 3));
  expect_kept(ring(), keeping(6, 3));
  expect_kept(membrane(), keeping(6, 2));
}

// The same delta loses them otherwise: the options above do something.
TEST(ThinLayersOfMeshes, AreLostWithoutTheOption) {
  MeshingOptions options = keeping(6, 3);
  options.sizes.thin = Thin::kLose;
  const MeshingResult lost = mesh_image(shells(), options);
  EXPECT_FALSE(lost.report.topology);
  EXPECT_FALSE(lost.mesh.topology_differences);
  const MeshingResult kept = mesh_image(shells(), keeping(6, 3));
  EXPECT_GT(kept.report.volume_of_label_mm3.at(10), 1.2 * lost.report.volume_of_label_mm3.at(10));
}

TEST(ThinLayersOfMeshes, RandomBlobsAreKept) {
  for (unsigned seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE(seed);
    expect_kept(blobs(seed), keeping(4, 2));
  }
}

TEST(ThinLayersOfMeshes, EveryAlgorithmAndExecutorKeepsThem) {
  for (const Algorithm algorithm :
       {Algorithm::kPodm, Algorithm::kPdr, Algorithm::kPdrPodm, Algorithm::kPodmHome})
    for (const Executor executor : {Executor::kThreads, Executor::kVirtual}) {
      SCOPED_TRACE(to_string(algorithm) + " " + to_string(executor));
      MeshingOptions options = keeping(6, 2);
      options.algorithm = algorithm;
      options.team.threads = 2;
      options.team.oversubscribe = true;
      options.team.executor = executor;
      expect_kept(membrane(), options);
    }
}

TEST(ThinLayersOfMeshes, OptionsThatDoNotFitAreRefused) {
  const LabelImage image = shells();
  MeshingOptions options = keeping(6, 3);
  options.sizes.delta_least_mm = 1;
  const std::string fault = fault_of<InputError>([&] { mesh_image(image, options); });
  EXPECT_NE(fault.find("delta-least 1 mm is above 0.7 mm"), std::string::npos) << fault;
  EXPECT_NE(fault.find("label 10 is 1 mm thick at voxel (3, 3, 2)"), std::string::npos) << fault;
  options.sizes.delta_least_mm = 4;
  EXPECT_NE(fault_of<InputError>([&] { mesh_image(image, options); }).find("is above delta, 3 mm"),
            std::string::npos);
  options.sizes.thin = Thin::kLose;
  EXPECT_NE(fault_of<InputError>([&] { mesh_image(image, options); }).find("needs"), std::string::npos);
  options = keeping(0, 0);
  options.sizes.target_elements = 1000;
  EXPECT_NE(fault_of<InputError>([&] { mesh_image(image, options); }).find("target-elements"),
            std::string::npos);
}

}  // namespace
}  // namespace podm::test
