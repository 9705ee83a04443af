// An image whose voxels stay in its file gives the same answers, to the bit, as the image that holds them.
#include <gtest/gtest.h>

#include <thread>

#include "closest_point.h"
#include "image/image_by_bricks.h"
#include "isosurface/isosurface.h"
#include "isosurface_reference.h"

namespace podm::test {
namespace {

LabelImage part_of(const LabelImage& image, const Voxel& low, const Voxel& high) {
  LabelImage part = image;
  part.size = {high.i - low.i, high.j - low.j, high.k - low.k};
  part.voxels.clear();
  for (int k = low.k; k < high.k; ++k)
    for (int j = low.j; j < high.j; ++j)
      for (int i = low.i; i < high.i; ++i) part.voxels.push_back(image.voxels[image.index(i, j, k)]);
  return part;
}

// Keeps a reference to the image.
ImageByBricks without_voxels(const LabelImage& image) {
  ImageByBricks in_file;
  static_cast<LabelImage&>(in_file) = image;
  in_file.voxels.clear();
  const BrickGrid bricks(image.size);
  SurfaceMasks masks(bricks.count());
  mark_surface(image, bricks, 1, masks);
  const auto [x, y, z] = bricks.size();
  for (int k = 0; k < z; ++k)
    for (int j = 0; j < y; ++j)
      for (int i = 0; i < x; ++i)
        in_file.label_of_brick.push_back(masks[bricks.index(i, j, k)] != 0
                                             ? ImageByBricks::kMixed
                                             : image.voxels[image.index(4 * i, 4 * j, 4 * k)]);
  in_file.read = [&image](const Voxel& low, const Voxel& high) { return part_of(image, low, high); };
  return in_file;
}

// Balls of several labels, far apart, and noise in one corner. Pages of bricks end inside.
LabelImage scene(std::array<int, 3> size, std::array<double, 3> spacing) {
  Random random(5);
  LabelImage image = empty_image(size, spacing);
  image.labels.resize(4);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        LabelIndex& label = image.voxels[image.index(i, j, k)];
        if (std::hypot(i - 30, j - 31, k - 33) < 14) label = i < 32 ? 1 : 2;
        if (std::hypot(i - 90, j - 40, k - 20) < 9) label = 3;
        if (std::max({i, j, k}) < 7) label = static_cast<LabelIndex>(random() % 4);
      }
  return image;
}

std::vector<LabelImage> scenes() {
  return {scene({101, 75, 70}, {1, 1, 1}), scene({131, 70, 67}, {0.7, 0.7, 1.9}),
          scene({140, 9, 6}, {1, 1.3, 1})};
}

void expect_same_answers(const Isosurface& whole, const Isosurface& in_file, const LabelImage& image,
                         std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < 4000; ++n) {
    const Point p = random_point(random, image, 20), q = random_point(random, image, 3);
    const double radius = uniform(random, 0, 60);
    EXPECT_EQ(in_file.label_at(q), whole.label_at(q));
    EXPECT_EQ(in_file.distance_lower_bound(p, radius), whole.distance_lower_bound(p, radius));
    const LabelAndBound here = in_file.label_and_bound(q, radius), there = whole.label_and_bound(q, radius);
    EXPECT_EQ(here.label, there.label);
    EXPECT_EQ(here.bound, there.bound);
    EXPECT_EQ(closest_point(in_file, p, radius), closest_point(whole, p, radius));
    EXPECT_EQ(in_file.segment_intersection(q, p), whole.segment_intersection(q, p));
  }
}

TEST(UnreadBricks, AnswerAsTheWholeImage) {
  for (const LabelImage& image : scenes()) {
    const ImageByBricks unread = without_voxels(image);
    const Isosurface whole(image, 1), in_file(unread, 2);
    EXPECT_EQ(in_file.transform().bytes_read(), 0u);
    expect_same_answers(whole, in_file, image, 1);
    EXPECT_GT(in_file.transform().bytes_read(), 0u);
  }
}

TEST(UnreadBricks, AreReadByAnyThread) {
  const LabelImage image = scenes()[0];
  const ImageByBricks unread = without_voxels(image);
  const Isosurface whole(image, 1);
  for (int trial = 0; trial < 5; ++trial) {
    const Isosurface in_file(unread, 1);
    std::vector<std::jthread> threads;
    for (std::uint64_t t = 0; t < 4; ++t)
      threads.emplace_back([&, t] { expect_same_answers(whole, in_file, image, t); });
  }
}

// A page has 64 voxels along each axis. Those of the other ball lie in the next page.
TEST(UnreadBricks, StayUnreadWhereNoQueryNeedsThem) {
  const LabelImage image = scenes()[0];
  const ImageByBricks unread = without_voxels(image);
  const Isosurface near_one(unread, 1), near_all(unread, 1);
  const auto ask = [](const Isosurface& isosurface, const Point& p) {
    EXPECT_NE(isosurface.label_at(p), kBackground);
    EXPECT_TRUE(isosurface.near_point(p, 20));
  };
  const Point of_one{30, 31, 33}, of_other{90, 40, 20};
  ask(near_one, of_one);
  ask(near_all, of_one);
  ask(near_all, of_other);
  EXPECT_LT(near_one.transform().bytes_read(), near_all.transform().bytes_read());
}

}  // namespace
}  // namespace podm::test
