// Components of smoothed labels, compared with those of a fine grid of points.
#include "run/report_on_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "image/components.h"
#include "image/working_frame.h"
#include "isosurface/isosurface.h"
#include "tests/images.h"

namespace podm {
namespace {

using test::make_image;

SmoothingReport report_of(const LabelImage& image, double width_mm) {
  return report_on_smoothing(image, width_mm, smooth_interfaces(image, width_mm, 1), 1);
}

// Returns the labels at `times` points per voxel along each axis, including the centers of voxels.
LabelImage refined(const LabelImage& image, double width_mm, int times) {
  const Isosurface isosurface(image, 1, smooth_interfaces(image, width_mm, 1).weights);
  const auto count = [&](std::size_t axis) { return times * (image.size[axis] - 1) + 1; };
  const auto at = [&](int i) { return static_cast<double>(i) / times; };
  return make_image({count(0), count(1), count(2)}, {1, 1, 1}, static_cast<int>(image.labels.size()) - 1,
                    [&](int i, int j, int k) {
                      return isosurface.label_at(map(voxels_to_working(image), Point{at(i), at(j), at(k)}));
                    });
}

// Returns the number of components that contain the center of a voxel.
std::uint64_t num_components(const LabelImage& refined, int times, LabelIndex label) {
  const Components components(refined);
  std::set<Components::Id> found;
  for (int k = 0; k < refined.size[2]; k += times)
    for (int j = 0; j < refined.size[1]; j += times)
      for (int i = 0; i < refined.size[0]; i += times)
        if (refined.voxels[refined.index(i, j, k)] == label) found.insert(components.of({i, j, k}));
  return found.size();
}

// Two cubes that share only an edge, and two cubes that are a voxel apart.
TEST(ReportOnSmoothing, ReportsComponentsThatGrowTogether) {
  for (const int gap : {0, 1}) {
    const LabelImage image = make_image({20, 20, 12}, {1, 1, 1}, 1, [&](int i, int j, int k) {
      const auto is_in = [&](int n, int from) { return n >= from && n < from + 6; };
      return is_in(k, 3) && ((is_in(i, 3) && is_in(j, 3)) || (is_in(i, 9 + gap) && is_in(j, 9 + gap)));
    });
    const SmoothingReport report = report_of(image, 1.5);
    ASSERT_EQ(report.labels.size(), 1U);
    EXPECT_EQ(report.labels[0].voxels_components, 2U);
    EXPECT_EQ(report.labels[0].smoothed_components, num_components(refined(image, 1.5, 8), 8, 1));
  }
}

TEST(ReportOnSmoothing, CountsComponentsAsAFineGridDoesButForFew) {
  constexpr int kTimes = 8;
  std::mt19937_64 random(1);
  std::uint64_t of_voxels = 0, of_report = 0, fine_of = 0;
  for (const double width : {0.6, 0.8, 1.1, 1.5}) {
    const LabelImage image = make_image({14, 13, 12}, {1, 1, 1}, 3, [&](int i, int j, int k) {
      const double wave = std::sin(0.9 * i) + std::sin(1.1 * j + 1) + std::sin(0.8 * k + 2);
      return random() % 16 == 0 ? static_cast<int>(random() % 4) : wave > 0.7 ? 1 : wave > -0.3 ? 2 : 0;
    });
    const SmoothingReport report = report_of(image, width);
    const LabelImage fine = refined(image, width, kTimes);
    for (LabelIndex label = 1; label < image.labels.size(); ++label) {
      const auto& reported = report.labels[label - 1u];
      const std::uint64_t of_fine = num_components(fine, kTimes, label);
      EXPECT_EQ(reported.voxels_components, num_components(image, 1, label));
      EXPECT_GE(reported.smoothed_components, of_fine) << "a way that bends may join, too";
      of_voxels += reported.voxels_components, of_report += reported.smoothed_components, fine_of += of_fine;
    }
  }
  EXPECT_LT(of_report - fine_of, (of_voxels - fine_of) / 10);
}

}  // namespace
}  // namespace podm
