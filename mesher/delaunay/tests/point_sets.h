// Point sets that expose careless kernels, all inside kBox.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <random>
#include <vector>

#include "delaunay/mesh.h"

namespace podm::test {

inline const Box kBox{{-10, -10, -10}, {10, 10, 10}};

struct PointSet {
  const char* name;
  std::function<std::vector<Point>()> make;
  friend std::ostream& operator<<(std::ostream& out, const PointSet& x) { return out << x.name; }
};

inline std::vector<Point> random_points(unsigned seed, int n, double scale, Point center = {0, 0, 0}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-scale, scale);
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    points.push_back(center + Point{uniform(random), uniform(random), uniform(random)});
  }
  return points;
}

inline std::vector<Point> grid(int n) {
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) points.push_back({i * 1.0 - n / 2, j * 1.0 - n / 2, k * 1.0 - n / 2});
    }
  }
  return points;
}

inline std::vector<Point> shuffled(std::vector<Point> points, unsigned seed) {
  std::shuffle(points.begin(), points.end(), std::mt19937_64(seed));
  return points;
}

// Returns exactly representable points of one sphere: permutations and signs of Pythagorean quadruples with r
// = 9.
inline std::vector<Point> cospherical() {
  std::vector<Point> points;
  for (const Point q : {Point{1, 4, 8}, Point{4, 4, 7}, Point{0, 0, 9}, Point{3, 6, 6}}) {
    for (int signs = 0; signs < 8; ++signs) {
      for (int turn = 0; turn < 3; ++turn) {
        Point p = turn == 0 ? q : turn == 1 ? Point{q.y, q.z, q.x} : Point{q.z, q.x, q.y};
        if (signs & 1) p.x = -p.x;
        if (signs & 2) p.y = -p.y;
        if (signs & 4) p.z = -p.z;
        if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
      }
    }
  }
  return points;
}

inline std::vector<Point> collinear() {
  std::vector<Point> points;
  for (int i = -40; i <= 40; ++i) points.push_back({i * 0.125, 0.5 * i * 0.125, -0.25 * i * 0.125});
  return points;
}

inline std::vector<Point> coplanar() {
  std::vector<Point> points = random_points(5, 200, 8);
  for (Point& p : points) p.z = 1;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) points.push_back({i * 1.0, j * 1.0, 1});
  }
  return points;
}

inline std::vector<Point> clustered() {
  std::vector<Point> points;
  for (unsigned c = 0; c < 5; ++c) {
    const Point center = random_points(100 + c, 1, 8)[0];
    for (const Point& p : random_points(c, 60, std::pow(10.0, -2.0 * c), center)) points.push_back(p);
  }
  return points;
}

inline std::vector<Point> nearly_degenerate() {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> ulps(-2, 2);
  std::vector<Point> points = grid(6);
  for (Point& p : points) {
    p.x += ulps(random) * 0x1p-51;
    p.y += ulps(random) * 0x1p-51;
    p.z += ulps(random) * 0x1p-51;
  }
  return points;
}

inline std::vector<PointSet> point_sets() {
  return {{"random", [] { return random_points(1, 500, 9); }},
          {"grid", [] { return grid(7); }},
          {"cospherical", cospherical},
          {"collinear", collinear},
          {"coplanar", coplanar},
          {"clustered", clustered},
          {"nearly_degenerate", nearly_degenerate}};
}

}  // namespace podm::test
