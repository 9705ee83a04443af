#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "claims/claims.h"
#include "claims/lines_of_image.h"
#include "image/smoothing.h"
#include "meshed_voxels.h"

namespace podm::verify {
namespace {

constexpr std::array<int, 3> kBlockSize{11, 9, 7};

// Labels 1, 2 and 3 meet along the axis k, and each meets background and another one around the block.
std::uint32_t three_sectors(int i, int j, int) { return i < 6 ? 1 : j < 5 ? 2 : 3; }

ClaimResult lines_of(const Mesh& mesh, const Image& image, double delta_mm, int threads = 2) {
  Options options;
  options.threads = threads;
  options.lines_delta_mm = delta_mm;
  return check_lines(mesh, mapped_adjacency(mesh), image, options);
}

double share(const ClaimResult& result, const char* way) { return result.details()[way]["share_near"]; }

std::vector<LinePoint> points_of(const Image& image, int threads = 2) {
  return lines_of_image(image, ImageFrame(image, Space::kRas), threads);
}

Image random_image(unsigned seed, std::uint32_t num_labels) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::uint32_t> label(0, num_labels - 1);
  return make_image({6, 5, 4}, kUnitAffine, [&](int, int, int) { return label(random); });
}

// Returns the largest difference of a coordinate.
double apart(const Point& a, const Point& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

Image flat_image(const LabelOf& label) {
  Image image = make_image(kBlockSize, kUnitAffine, label);
  image.is_box_flat = true;
  return image;
}

std::uint32_t two_halves(int i, int, int) { return i < 6 ? 1 : 2; }

// Inside the block the weights are 1-x, x(1-y) and xy: they are equal at x = 2/3, y = 1/2.
TEST(LinesOfImage, LieWhereThreeWeightsAreEqual) {
  const Image image = make_image(kBlockSize, kUnitAffine, three_sectors);
  std::size_t num_inner = 0;
  std::vector<bool> is_met(60);
  for (const LinePoint& point : points_of(image)) {
    if (point.labels != std::vector<std::uint32_t>{1, 2, 3}) continue;
    EXPECT_TRUE(std::includes(point.labels.begin(), point.labels.end(), &point.labels[0], &point.labels[1]));
    if (!point.is_decided || point.voxels[2] < 0 || point.voxels[2] > 6) continue;
    ++num_inner;
    EXPECT_NEAR(point.voxels[0], 5 + 2.0 / 3, side_of_floor_voxels());
    EXPECT_NEAR(point.voxels[1], 4.5, side_of_floor_voxels());
    is_met[static_cast<std::size_t>(point.voxels[2] * 10)] = true;
  }
  EXPECT_GT(num_inner, 60);
  EXPECT_TRUE(std::all_of(is_met.begin(), is_met.end(), [](bool met) { return met; }));
}

// Two labels fill the box. They meet the outside in a closed line around it, in the planes of four sides.
TEST(LinesOfImage, LieInThePlanesOfAFlatBox) {
  std::array<std::size_t, 4> num_on_side{};
  for (const LinePoint& point : points_of(flat_image(two_halves))) {
    EXPECT_EQ(point.labels, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_NEAR(point.voxels[0], 5.5, side_of_floor_voxels());
    std::size_t num_sides = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      const std::size_t axis = 1 + side / 2;
      if (point.voxels[axis] != (side % 2 == 0 ? -0.5 : kBlockSize[axis] - 0.5)) continue;
      ++num_sides;
      ++num_on_side[side];
    }
    EXPECT_GE(num_sides, 1U);
  }
  for (const std::size_t count : num_on_side) EXPECT_GT(count, 60U);
}

TEST(LinesOfImage, HaveTheirLabelsAround) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Image image = random_image(seed, 4);
    const LabelFunction function(image);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> step(-1.01 * side_of_floor_voxels(),
                                                1.01 * side_of_floor_voxels());
    std::size_t num_decided = 0, num_all_seen = 0;
    for (const LinePoint& point : points_of(image)) {
      if (!point.is_decided) continue;
      ++num_decided;
      std::set<std::uint32_t> seen;
      for (int i = 0; i < 400; ++i)
        seen.insert(function.label_at({point.voxels[0] + step(random), point.voxels[1] + step(random),
                                       point.voxels[2] + step(random)}));
      num_all_seen += std::includes(seen.begin(), seen.end(), point.labels.begin(), point.labels.end());
    }
    EXPECT_GT(num_decided, 1000);
    EXPECT_GE(static_cast<double>(num_all_seen), 0.995 * static_cast<double>(num_decided)) << seed;
  }
}

// A tenth of a voxel around a place with three labels there is a box of the floor, except where one of them
// is thinner than that.
TEST(LinesOfImage, AreFoundWhereverThreeLabelsAreSeen) {
  constexpr double kStep = 0.1;
  for (unsigned seed = 11; seed <= 14; ++seed) {
    const Image image = random_image(seed, 4);
    const LabelFunction function(image);
    const auto points = points_of(image);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(-1, 6), y(-1, 5), z(-1, 4);
    int num_seen = 0, num_found = 0;
    while (num_seen < 300) {
      const Point u{x(random), y(random), z(random)};
      std::set<std::uint32_t> labels;
      for (int c = 0; c < 8; ++c)
        labels.insert(function.label_at(
            {u[0] + kStep * (c & 1), u[1] + kStep * (c >> 1 & 1), u[2] + kStep * (c >> 2)}));
      if (labels.size() < 3) continue;
      ++num_seen;
      num_found += std::any_of(points.begin(), points.end(), [&](const LinePoint& point) {
        return apart(point.voxels, u) < 3 * kStep &&
               std::includes(point.labels.begin(), point.labels.end(), labels.begin(), labels.end());
      });
    }
    EXPECT_GE(num_found, 285) << seed;
  }
}

TEST(LinesOfImage, AreTheSameOnAnyNumberOfThreads) {
  const Image image = random_image(5, 5);
  const auto one = points_of(image, 1);
  for (const int threads : {2, 3, 7}) {
    const auto more = points_of(image, threads);
    ASSERT_EQ(more.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(more[i].voxels, one[i].voxels);
      EXPECT_EQ(more[i].labels, one[i].labels);
    }
  }
}

TEST(Lines, IsNotRunWithoutADistance) {
  const Image image = make_image(kBlockSize, kUnitAffine, three_sectors);
  const Mesh mesh = kuhn_mesh(image);
  EXPECT_EQ(check_lines(mesh, mapped_adjacency(mesh), image, {}).verdict, Verdict::kNotRun);
  Mesh promising = mesh;
  promising.promised_lines_delta_mm = 1;
  EXPECT_EQ(check_lines(promising, mapped_adjacency(promising), image, {}).verdict, Verdict::kPass);
}

// The edges of voxels are within a fifth of a voxel of the lines of this image, and 0.04 is half of a box.
TEST(Lines, HoldsForTheVoxelsThemselves) {
  for (const auto& affine : kAffines) {
    const Image image = make_image(kBlockSize, affine, three_sectors);
    const Mesh mesh = kuhn_mesh(image);
    const double longest = *std::max_element(image.spacing.begin(), image.spacing.end());
    const ClaimResult result = lines_of(mesh, image, longest);
    EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
    EXPECT_EQ(share(result, "image_to_mesh"), 1);
    EXPECT_EQ(share(result, "mesh_to_image"), 1);
    EXPECT_EQ(lines_of(mesh, image, 0.2 * longest).verdict, Verdict::kFail);
  }
}

TEST(Lines, RefutesAMeshThatLacksALine) {
  const Image image = make_image(kBlockSize, kUnitAffine, three_sectors);
  Mesh mesh = kuhn_mesh(image);
  for (LabelValue& label : mesh.cell_labels) label = label == 3 ? 2 : label;
  const ClaimResult result = lines_of(mesh, image, 1);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_LT(share(result, "image_to_mesh"), 0.9);
  EXPECT_FALSE(result.worst.empty());
}

TEST(Lines, AreJudgedInTheSidesOfAFlatBox) {
  const Image halves = flat_image(two_halves), sectors = flat_image(three_sectors);
  Mesh mesh = kuhn_mesh(halves);
  EXPECT_EQ(lines_of(mesh, halves, 0.2).verdict, Verdict::kPass);
  EXPECT_EQ(lines_of(kuhn_mesh(sectors), sectors, 1).verdict, Verdict::kPass);
  EXPECT_EQ(lines_of(mesh, sectors, 1).verdict, Verdict::kFail) << "the line inside and its ends are missing";
  EXPECT_EQ(lines_of(kuhn_mesh(sectors), halves, 1).verdict, Verdict::kFail);
  const Mesh beside = kuhn_mesh(flat_image([](int i, int, int) { return i < 7 ? 1 : 2; }));
  EXPECT_EQ(lines_of(beside, halves, 1).verdict, Verdict::kFail);
  for (LabelValue& label : mesh.cell_labels) label = 1;
  EXPECT_EQ(lines_of(mesh, halves, 1).verdict, Verdict::kFail);
}

TEST(Lines, RefutesAMeshWithALineThatTheImageLacks) {
  const Image image = make_image(kBlockSize, kUnitAffine, [](int i, int, int) { return i < 6 ? 1 : 2; });
  const Mesh mesh = kuhn_mesh(make_image(kBlockSize, kUnitAffine, three_sectors));
  const ClaimResult result = lines_of(mesh, image, 1);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_LT(share(result, "mesh_to_image"), 0.9);
}

TEST(Lines, RefutesALineBetweenOtherLabels) {
  const Image image = make_image(kBlockSize, kUnitAffine, three_sectors);
  Mesh mesh = kuhn_mesh(image);
  for (LabelValue& label : mesh.cell_labels) label = label == 3 ? 4 : label;
  EXPECT_EQ(lines_of(mesh, image, 1).verdict, Verdict::kFail);
}

TEST(Lines, JudgesTheDistance) {
  const Image image = make_image(kBlockSize, kUnitAffine, three_sectors);
  const auto moved = [&](double by) {
    Mesh mesh = kuhn_mesh(image);
    for (Point& p : mesh.vertices) p[1] += by;
    return lines_of(mesh, image, 1).verdict;
  };
  EXPECT_EQ(moved(0.1), Verdict::kPass);
  EXPECT_EQ(moved(0.75), Verdict::kFail);  // 1.5 times the bound
}

TEST(Lines, ReportIsTheSameOnAnyNumberOfThreads) {
  const Image image = make_image(kBlockSize, kSheared, three_sectors);
  const Mesh mesh = kuhn_mesh(image);
  EXPECT_EQ(lines_of(mesh, image, 1, 1).reason, lines_of(mesh, image, 1, 3).reason);
}

TEST(Lines, UsesTheSmoothedImage) {
  const auto ball = [](int i, int j, int k) {
    return std::hypot(i - 8, j - 8, k - 8) > 6 ? 0u : i < 8 ? 1u : 2u;
  };
  Image image = make_image({17, 17, 17}, kUnitAffine, ball);
  // Returns the standard deviation of the circle's radius.
  const auto roughness = [&] {
    double sum = 0, sum_of_squares = 0, number = 0;
    for (const LinePoint& point : points_of(image)) {
      if (!point.is_decided) continue;
      const double radius = std::hypot(point.voxels[1] - 8, point.voxels[2] - 8);
      sum += radius;
      sum_of_squares += radius * radius;
      ++number;
    }
    return std::sqrt(sum_of_squares / number - (sum / number) * (sum / number));
  };
  const double of_voxels = roughness();
  image.smoothing = smooth(image, 1.5, 1);
  EXPECT_LT(roughness(), 0.8 * of_voxels);
}

}  // namespace
}  // namespace podm::verify
