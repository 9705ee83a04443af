// Circumspheres and the decisions that use them: cached, filtered and exact.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "geometry/circumsphere.h"

namespace podm {
namespace {

std::vector<Point> random_points(std::size_t n) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points(n);
  for (Point& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

constexpr std::size_t kPoints = 1 << 10;

void BM_circumsphere(benchmark::State& state) {
  const std::vector<Point> p = random_points(kPoints + 3);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(circumsphere(p[i], p[i + 1], p[i + 2], p[i + 3], 1.0));
    i = (i + 1) % kPoints;
  }
}
BENCHMARK(BM_circumsphere);

void BM_cached_conflict_test(benchmark::State& state) {
  const std::vector<Point> p = random_points(kPoints + 4);
  std::vector<Circumsphere> spheres;
  for (std::size_t i = 0; i < kPoints; ++i)
    spheres.push_back(circumsphere(p[i], p[i + 1], p[i + 2], p[i + 3], 1.0));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(side_of(spheres[i], p[i + 4]));
    i = (i + 1) % kPoints;
  }
}
BENCHMARK(BM_cached_conflict_test);

void BM_orientation(benchmark::State& state) {
  const std::vector<Point> p = random_points(kPoints + 3);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(orientation(p[i], p[i + 1], p[i + 2], p[i + 3]));
    i = (i + 1) % kPoints;
  }
}
BENCHMARK(BM_orientation);

void BM_exact_conflict_test_of_cospherical_points(benchmark::State& state) {
  const Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1}, p{1, 1, 1};
  for (auto _ : state) benchmark::DoNotOptimize(in_circumsphere(a, b, c, d, p));
}
BENCHMARK(BM_exact_conflict_test_of_cospherical_points);

}  // namespace
}  // namespace podm
