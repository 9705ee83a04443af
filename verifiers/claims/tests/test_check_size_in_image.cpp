// Compares bounds near interfaces of an image, and bounds that grow, with the statements of check_size.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "claims/graded_sizes.h"
#include "claims/interface_faces.h"
#include "claims/tests/small_meshes.h"
#include "errors.h"
#include "geometry/circumcenter.h"

namespace podm::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Options options_near(std::vector<std::string> near, std::optional<double> grade = std::nullopt) {
  Options options = two_threads();
  for (const std::string& text : near) options.interface_sizes.push_back(parse_interface_size(text));
  options.grade = grade;
  return options;
}

Image random_image(const std::array<double, 12>& affine, std::mt19937& random) {
  std::uniform_int_distribution<std::uint32_t> label(0, 3);
  Image image = make_image({7, 6, 5}, affine, [&](int, int, int) { return label(random); });
  image.path = "random.nii";
  return image;
}

// Returns cells that share nothing, with vertices around the image's voxels; with `lattice` at half voxels.
Mesh random_cells(const Image& image, bool lattice, std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 8), size(0.5, 3);
  const ImageFrame frame(image, Space::kRas);
  Mesh mesh;
  for (VertexId c = 0; c < 120; ++c) {
    const Point around{coordinate(random), coordinate(random), coordinate(random)};
    const double edge = size(random);
    for (const Point& corner : random_points(4, random)) {
      Point p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = around[axis] + edge * corner[axis];
        if (lattice) p[axis] = std::round(2 * p[axis]) / 2;
      }
      mesh.vertices.push_back(frame.voxels_to_mesh(p));
    }
    mesh.cells.push_back({4 * c, 4 * c + 1, 4 * c + 2, 4 * c + 3});
  }
  return mesh;
}

std::uint32_t label_at(const Image& image, const std::array<int, 3>& v) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (v[axis] < 0 || v[axis] >= image.size[axis]) return 0;
  return image.voxels[static_cast<std::size_t>((v[2] * image.size[1] + v[1]) * image.size[0] + v[0])];
}

bool holds(const std::vector<std::uint32_t>& labels, std::uint32_t label) {
  return std::find(labels.begin(), labels.end(), label) != labels.end();
}

// Calls use(voxel) for all voxels, and for voxels up to `margin` around the image.
template <class Use>
void for_each_voxel(const std::array<int, 3>& size, int margin, const Use& use) {
  for (int k = -margin; k < size[2] + margin; ++k)
    for (int j = -margin; j < size[1] + margin; ++j)
      for (int i = -margin; i < size[0] + margin; ++i) use(std::array<int, 3>{i, j, k});
}

// Returns the squared distance of the nearest face between voxels of either side, in any of the types.
template <class T>
T squared_distance(const Image& image, const InterfaceSize& near, const Vector<T>& voxel) {
  std::optional<T> least;
  for_each_voxel(image.size, 1, [&](const std::array<int, 3>& v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<int, 3> next = v;
      ++next[axis];
      const std::uint32_t a = label_at(image, v), b = label_at(image, next);
      if (!(holds(near.labels[0], a) && holds(near.labels[1], b)) &&
          !(holds(near.labels[1], a) && holds(near.labels[0], b)))
        continue;
      T sum(0);
      for (std::size_t i = 0; i < 3; ++i) {
        const T low = T(v[i]) + T(i == axis ? 0.5 : -0.5), high = T(v[i]) + T(0.5);
        const T beyond = voxel[i] < low ? low - voxel[i] : voxel[i] > high ? voxel[i] - high : T(0);
        sum = sum + T(image.spacing[i]) * T(image.spacing[i]) * beyond * beyond;
      }
      if (!least || sum < *least) least = sum;
    }
  });
  return *least;
}

std::vector<GlobalId> over_near_by_definition(const Mesh& mesh, const Image& image,
                                              const InterfaceSize& near) {
  const VoxelMap to_voxels(image.voxel_to_ras, mesh.space);
  const Rational radius(near.radius_mm), width(near.width_mm);
  std::vector<GlobalId> over;
  for (CellId c = 0; c < mesh.cells.size(); ++c) {
    const CellPoints p = points_of(mesh, c);
    const auto center = circumcenter<Rational>(p);
    const auto r2 = squared_circumradius<Rational>(p);
    if (!center || (r2.numerator > radius * radius * r2.denominator &&
                    squared_distance(image, near, to_voxels(*center)) <= width * width))
      over.push_back(c);
  }
  return over;
}

TEST(SizeInImage, IsBoundedNearAnInterfaceAsAllOfItsFacesSay) {
  std::mt19937 random(5);
  for (const auto& affine : kAffines)
    for (const char* text : {"1,2=0.5:0.5", "0,3=1", "2,0+1=0.75:1.5", "1,3=0.25:0.25"})
      for (const bool lattice : {true, false}) {
        const Image image = random_image(affine, random);
        const Mesh mesh = random_cells(image, lattice, random);
        const Options options = options_near({text});
        const ClaimResult result = check_size(mesh, &image, nullptr, options);
        const auto over = over_near_by_definition(mesh, image, options.interface_sizes[0]);
        EXPECT_EQ(result.bad_cells, over) << text;
        EXPECT_GT(over.size(), 0U);
        EXPECT_LT(over.size(), mesh.cells.size());
      }
}

// Returns label 1 up to x = 3.5, then label 2, in voxels of 1 mm.
Image halves() {
  return make_image({8, 4, 4}, kUnitAffine, [](int i, int, int) { return i < 4 ? 1U : 2U; });
}

Verdict verdict_of(const Mesh& mesh, const Image& image, const Options& options) {
  return check_size(mesh, &image, nullptr, options).verdict;
}

TEST(SizeInImage, MeasuresTheNearestFace) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> coordinate(-4, 10);
  for (const auto& affine : kAffines) {
    const Image image = random_image(affine, random);
    const InterfaceSize near = parse_interface_size("1,2=1");
    const InterfaceFaces faces(image, near);
    for (int repeat = 0; repeat < 200; ++repeat) {
      const Point voxel{coordinate(random), coordinate(random), coordinate(random)};
      const double distance = std::sqrt(squared_distance<double>(image, near, voxel));
      EXPECT_NEAR(faces.distance_mm(voxel, kInfinity), distance, 1e-12);
      EXPECT_NEAR(faces.distance_mm(voxel, distance * 1.1), distance, 1e-12);
      EXPECT_EQ(faces.distance_mm(voxel, distance * 0.9), distance * 0.9);
    }
  }
}

TEST(SizeInImage, HoldsAtTheVeryWidthAndNotAnUlpBeyond) {
  const Image image = halves();
  const Mesh mesh = corner(2, 2, 2);  // circumcenter (1, 1, 1), 2.5 from the interface, circumradius sqrt(3)
  Options options = options_near({"1,2=1.7:2.5"});
  EXPECT_EQ(verdict_of(mesh, image, options), Verdict::kFail);
  options.interface_sizes[0].width_mm = std::nextafter(2.5, 0);
  EXPECT_EQ(verdict_of(mesh, image, options), Verdict::kPass);
  EXPECT_EQ(verdict_of(mesh, image, options_near({"2,1=1.74:9"})), Verdict::kPass) << "it is small enough";
  EXPECT_EQ(verdict_of(mesh, image, options_near({"2,1=1.74:9", "1,0=1.7:1.5"})), Verdict::kFail)
      << "background is outside, from -0.5";
  EXPECT_EQ(verdict_of(mesh, image, options_near({"2,1=1.74:9", "1,0=1.7:1.4999"})), Verdict::kPass);
}

TEST(SizeInImage, FollowsTheSpaceOfTheMesh) {
  const Image image = halves();
  const Options options = options_near({"1,2=1.7:2.5"});
  Mesh lps = corner(2, 2, 2);
  lps.space = Space::kLps;
  EXPECT_EQ(verdict_of(lps, image, options), Verdict::kPass) << "it is elsewhere";
  for (Point& p : lps.vertices) p[0] = -p[0], p[1] = -p[1];
  EXPECT_EQ(verdict_of(lps, image, options), Verdict::kFail);
  Mesh voxels = corner(2, 2, 2);
  voxels.space = Space::kVoxel;
  EXPECT_EQ(verdict_of(voxels, image, options), Verdict::kNotRun);
}

// Returns the mean of the eight voxels around that have a size, by trilinear weights; 0 if none has.
double size_at(const SizeImage& sizes, const Point& voxel) {
  double sum = 0, weights = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (voxel[axis] < -0.5 || voxel[axis] > sizes.size[axis] - 0.5) return 0;
  std::size_t number = 0;
  for_each_voxel(sizes.size, 0, [&](const std::array<int, 3>& v) {
    double weight = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      weight *= std::max(0.0, 1 - std::abs(std::clamp(voxel[axis], 0.0, sizes.size[axis] - 1.0) - v[axis]));
    const double radius = sizes.radius_mm[number++];
    if (radius == 0) return;
    sum += weight * radius;
    weights += weight;
  });
  return weights > 0 ? sum / weights : 0;
}

// Computes the bound that check_size.cpp states for a grade, word for word, without the rounding of single
// precision.
double grown_by_definition(const Point& voxel, const Image& image, const SizeImage& sizes,
                           const Options& options) {
  const double diagonal = std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
  const auto distance = [&](const Point& a, const Point& b) {
    return std::hypot((a[0] - b[0]) * image.spacing[0], (a[1] - b[1]) * image.spacing[1],
                      (a[2] - b[2]) * image.spacing[2]);
  };
  const auto point = [](const std::array<int, 3>& v) {
    return Point{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  };
  const ImageFrame frame(image, Space::kRas);
  const Image sizes_as_image = make_image({1, 1, 1}, sizes.voxel_to_ras, [](int, int, int) { return 0U; });
  const ImageFrame frame_of_sizes(sizes_as_image, Space::kRas);
  const double grade = *options.grade;
  double least = kInfinity;
  const auto bound = [&](double radius, double far, double slack) {
    if (radius > 0) least = std::min(least, radius + grade * (far + slack * diagonal));
  };
  for_each_voxel(image.size, 0, [&](const std::array<int, 3>& v) {
    const std::uint32_t label = label_at(image, v);
    const double far = distance(voxel, point(v));
    if (label != 0) bound(options.radius_of_label(label).value_or(0), far, 0.5);
    const double size = size_at(sizes, frame_of_sizes.world_to_voxels(frame.voxels_to_world(point(v))));
    bound(options.size_factor * size, far, 0.5);
  });
  std::size_t number = 0;
  for_each_voxel(sizes.size, 0, [&](const std::array<int, 3>& v) {
    const double radius = options.size_factor * sizes.radius_mm[number++];
    const Point at = frame.world_to_voxels(frame_of_sizes.voxels_to_world(point(v)));
    const std::array<int, 3> nearest{static_cast<int>(std::round(at[0])), static_cast<int>(std::round(at[1])),
                                     static_cast<int>(std::round(at[2]))};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (nearest[axis] < 0 || nearest[axis] >= image.size[axis]) return;
    bound(radius, 3 * distance(at, point(nearest)) + distance(voxel, point(nearest)), 0.5);
  });
  for (const InterfaceSize& near : options.interface_sizes) {
    const double far = std::sqrt(squared_distance<double>(image, near, voxel));
    bound(near.radius_mm, std::max(0.0, far - near.width_mm), 1.5);
  }
  return least;
}

SizeImage random_sizes(std::mt19937& random) {
  std::uniform_real_distribution<float> radius(0.5F, 4);
  SizeImage sizes{.path = "sizes.nii",
                  .size = {5, 4, 6},
                  .voxel_to_ras = {0.9, 0.2, 0, -19, -0.1, 1.1, 0.3, 29.5, 0, 0.2, 3, 3},
                  .radius_mm = std::vector<float>(120)};
  for (float& each : sizes.radius_mm) each = radius(random) < 2 ? 0 : radius(random);
  return sizes;
}

TEST(SizeInImage, GrowsFromVoxelsSizesAndInterfacesAsStated) {
  std::mt19937 random(6);
  std::size_t num_over = 0;
  for (const auto& affine : kAffines)
    for (const double grade : {0.05, 0.4, 2.0}) {
      const Image image = random_image(affine, random);
      const SizeImage sizes = random_sizes(random);
      Options options = options_near({"1,2=0.5:0.25", "3,0=0.75"}, grade);
      options.radius_of = {{2, 0.4}, {3, 1.5}};
      options.size_factor = 0.7;
      const std::vector<InterfaceFaces> near{InterfaceFaces(image, options.interface_sizes[0]),
                                             InterfaceFaces(image, options.interface_sizes[1])};
      const GradedSizes graded(image, &sizes, near, options);
      const ImageFrame frame(image, Space::kRas);
      const Mesh mesh = random_cells(image, false, random);
      for (const Point& p : mesh.vertices) {
        const Point voxel = frame.to_voxels(p);
        const double bound = grown_by_definition(voxel, image, sizes, options);
        EXPECT_NEAR(graded.bound_at(voxel, kInfinity), bound, 2e-6 * bound);
        EXPECT_EQ(graded.bound_at(voxel, bound / 2), bound / 2);
        EXPECT_NEAR(graded.bound_at(voxel, bound * 1.5), bound, 2e-6 * bound);
      }
      const ClaimResult result = check_size(mesh, &image, &sizes, options);
      for (CellId c = 0; c < mesh.cells.size(); ++c) {
        const CellPoints p = points_of(mesh, c);
        const auto sphere = circumsphere(p, VoxelMap(image.voxel_to_ras, mesh.space));
        const bool is_bad = std::binary_search(result.bad_cells.begin(), result.bad_cells.end(), c);
        const bool is_over = sphere->radius > grown_by_definition(sphere->voxel, image, sizes, options);
        EXPECT_TRUE(is_bad || !is_over) << c;
        num_over += is_over;
      }
    }
  EXPECT_GT(num_over, 300U);
}

TEST(SizeInImage, ACellIsOverItsGradeJustBeyondTheSlack) {
  const Image image =
      make_image({9, 3, 3}, kUnitAffine, [](int i, int j, int k) { return i + j + k == 0 ? 2U : 1U; });
  const Mesh mesh = shifted(corner(2, 2, 2), {4, -1, -1});  // circumcenter (5, 0, 0), circumradius sqrt(3)
  Options options = options_near({}, 0.25);
  const double slack = 0.25 * std::sqrt(3) / 2, bound = std::sqrt(3) - 0.25 * 5 - slack;
  for (const auto& [radius, verdict] :
       {std::pair{bound + 1e-5, Verdict::kPass}, std::pair{bound - 1e-5, Verdict::kFail}}) {
    options.radius_of[2] = radius;
    EXPECT_EQ(verdict_of(mesh, image, options), verdict);
    const ClaimResult result = check_size(mesh, &image, nullptr, options);
    EXPECT_NEAR(result.worst.at(0).severity, 1, 1e-4);
    EXPECT_NEAR(result.details()["grade"]["slack_of_voxels_mm"].get<double>(), slack, 1e-12);
  }
}

TEST(SizeInImage, NodesAreEveryNthVoxel) {
  EXPECT_EQ(stride_of_nodes({1, 1, 1}), 1);
  EXPECT_EQ(stride_of_nodes({512, 512, 256}), 1) << "2^26";
  EXPECT_EQ(stride_of_nodes({512, 512, 257}), 2);
  EXPECT_EQ(stride_of_nodes({1290, 1290, 1290}), 4);
}

TEST(SizeInImage, PyramidsFindTheLeast) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-3, 12);
  std::uniform_real_distribution<float> value(1, 9);
  for (const std::array<int, 3> size : {std::array{1, 1, 1}, std::array{9, 5, 7}, std::array{8, 1, 4}}) {
    const std::array<double, 3> spacing{0.5, 2, 1.25};
    std::vector<float> values(static_cast<std::size_t>(size[0] * size[1] * size[2]));
    for (float& each : values)
      each = value(random) < 3 ? value(random) : std::numeric_limits<float>::infinity();
    const MinimaPyramid pyramid(size, spacing, 0.7, values);
    for (int repeat = 0; repeat < 200; ++repeat) {
      const Point p{coordinate(random), coordinate(random), coordinate(random)};
      double least = 9;
      std::size_t number = 0;
      for_each_voxel(size, 0, [&](const std::array<int, 3>& v) {
        const double far = std::hypot((p[0] - v[0]) * 0.5, (p[1] - v[1]) * 2, (p[2] - v[2]) * 1.25);
        least = std::min(least, values[number++] + 0.7 * far);
      });
      EXPECT_NEAR(pyramid.least_at(p, 9), least, 1e-12);
    }
  }
}

TEST(SizeInImage, NeedsAnImageAndABound) {
  const Image image = halves();
  EXPECT_NE(check_size(corner(2, 2, 2), nullptr, nullptr, options_near({"1,2=1"})).reason.find("--image"),
            std::string::npos);
  const ClaimResult alone = check_size(corner(2, 2, 2), &image, nullptr, options_near({}, 0.5));
  EXPECT_EQ(alone.verdict, Verdict::kNotRun);
  EXPECT_NE(alone.reason.find("no bound"), std::string::npos);
}

std::string fault_of(const std::string& text) {
  try {
    Image image = halves();
    image.path = "halves.nii";
    image.voxels[0] = 3;
    InterfaceFaces(image, parse_interface_size(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SizeInImage, RefusesLabelsThatHaveNoInterface) {
  EXPECT_EQ(fault_of("1,2=1"), "");
  EXPECT_EQ(fault_of("1,7=1"), "halves.nii: --size-near 1,7=1: no voxel has label 7");
  EXPECT_EQ(fault_of("1+2,2=1"), "halves.nii: --size-near 1+2,2=1: label 2 is on both sides");
  EXPECT_EQ(fault_of("2,3=1"), "halves.nii: --size-near 2,3=1: no voxels of the two sides touch");
  for (const char* text : {"1=2", "1,2", ",1=2", "1,=2", "1,2=x", "1,2=1:", "liver,0=1", "1,-2=1", "1+,2=1"})
    EXPECT_NE(fault_of(text).find("--size-near"), std::string::npos) << text;
  for (const char* text : {"1,2=0", "1,2=-1", "1,2=inf", "1,2=nan", "1,2=1:0", "1,2=1:inf"})
    EXPECT_NE(fault_of(text).find("not a positive, finite length"), std::string::npos) << text;
}

}  // namespace
}  // namespace podm::verify
