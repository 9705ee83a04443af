// Oracle queries on a torus with a skin, at points that are typical for a mesher, and the feature transform.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "isosurface/isosurface.h"
#include "isosurface/tests/closest_point.h"

namespace podm {
namespace {

// Returns a torus of label 2 in a skin of label 1 that is three voxels thick.
LabelImage torus(std::array<int, 3> size) {
  LabelImage image;
  image.size = size;
  image.spacing = {0.6, 0.6, 1.2};
  image.voxel_to_ras = {0.6, 0, 0, 0, 0, 0.6, 0, 0, 0, 0, 1.2, 0};
  image.voxels.resize(image.num_voxels());
  const std::array<double, 3> extent = {size[0] * 0.6, size[1] * 0.6, size[2] * 1.2};
  const double ring = 0.3 * std::min(extent[0], extent[1]), tube = std::min(0.4 * ring, 0.4 * extent[2]);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        const double x = i * 0.6 - extent[0] / 2, y = j * 0.6 - extent[1] / 2, z = k * 1.2 - extent[2] / 2;
        const double depth = tube - std::hypot(std::hypot(x, y) - ring, z);
        image.voxels[image.index(i, j, k)] = depth > 1.8 ? 2 : depth > 0;
      }
  return image;
}

struct Queries {
  LabelImage image = torus({200, 200, 60});
  Isosurface isosurface{image, 0};
  std::vector<Point> near, far;  // less than a voxel, and more than three voxels, from the isosurface

  Queries() {
    std::mt19937_64 random(1);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto around = [&](const Point& p, double reach) {
      return p + Vector{uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
    };
    while (near.size() < kPoints) {
      const Point a = {uniform(0, 120), uniform(0, 120), uniform(0, 72)};
      for (int n = 0; n < 50; ++n) {  // queries for neighbours follow each other
        const Point b = around(a, 5);
        if (isosurface.distance_lower_bound(b, 2) > 2) far.push_back(b);
        if (const auto z = isosurface.segment_intersection(b, around(b, 5))) near.push_back(around(*z, 0.4));
      }
    }
  }
  static constexpr std::size_t kPoints = 20000;
};

const Queries& queries() {
  static const Queries kQueries;
  return kQueries;
}

template <class Ask>
void ask_all(benchmark::State& state, const std::vector<Point>& points, Ask&& ask) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(ask(points[i]));
    if (++i == points.size()) i = 0;
  }
}

void label_far(benchmark::State& state) {
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().far, [&](const Point& p) { return isosurface.label_at(p); });
}
void label_near(benchmark::State& state) {
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().near, [&](const Point& p) { return isosurface.label_at(p); });
}
void distance_lower_bound_far(benchmark::State& state) {
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().far, [&](const Point& p) { return isosurface.distance_lower_bound(p, 1); });
}
void distance_lower_bound_near(benchmark::State& state) {
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().near, [&](const Point& p) { return isosurface.distance_lower_bound(p, 1); });
}
void closest_point_near(benchmark::State& state) {
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().near, [&](const Point& p) { return test::closest_point(isosurface, p, 10); });
}
void segment_intersection_near(benchmark::State& state) {
  const Vector step{0.3, -0.2, 0.2};
  const Isosurface& isosurface = queries().isosurface;
  ask_all(state, queries().near,
          [&](const Point& p) { return isosurface.segment_intersection(p, p + step); });
}
void feature_transform_512x512x200(benchmark::State& state) {
  const LabelImage image = torus({512, 512, 200});
  for (auto _ : state) {
    const FeatureTransform transform(image, static_cast<int>(state.range(0)));
    benchmark::DoNotOptimize(transform.words().back());
  }
}

BENCHMARK(label_far);
BENCHMARK(label_near);
BENCHMARK(distance_lower_bound_far);
BENCHMARK(distance_lower_bound_near);
BENCHMARK(closest_point_near);
BENCHMARK(segment_intersection_near);
BENCHMARK(feature_transform_512x512x200)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace podm
