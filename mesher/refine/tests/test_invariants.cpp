// Bounds of the invariants: an operation that the rules allow keeps them, one slightly beyond does not.
#include "refine/tests/invariants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "delaunay/tests/triangulator.h"
#include "podm/mesh_image.h"
#include "refine/rules.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr double kSlack = 1e-6;
constexpr double kSpacing = 1;

// A cell deep in a ball of one label, with vertices on a sphere of the given radius and a shortest edge of 1.
class NeedleInABall {
 public:
  explicit NeedleInABall(double radius) {
    const double half = 0.5 / radius, height = radius * std::sqrt(1 - half * half), wide = 0.8 * radius;
    for (const Vector& d :
         {Vector{0.5, 0, height}, {-0.5, 0, height}, {0, wide, -0.6 * radius}, {0, -wide, -0.6 * radius}})
      triangulator.insert(center_ + d, VertexKind::kIsosurface);
  }
  std::optional<Rule> rule() {
    const Rules rules(triangulator.mesh, isosurface_, parameters_);
    for (CellId c = 0; c < triangulator.mesh.cell_bound(); ++c) {
      const auto& vertices = triangulator.mesh.cell(c).vertices;
      const auto is_sample = [&](VertexId v) {
        return triangulator.mesh.vertex(v).kind == VertexKind::kIsosurface;
      };
      if (triangulator.mesh.cell(c).is_alive() && std::all_of(vertices.begin(), vertices.end(), is_sample))
        return rules.volume_rule(rules.examine(c));
    }
    throw std::runtime_error("the cell is not there");
  }
  void insert_center() { triangulator.insert(center_); }

  Triangulator triangulator{{{-20, -20, -20}, {40, 40, 40}}};

 private:
  static constexpr Point center_{4.5, 22.5, 14.5};  // the ball's
  LabelImage image_ = ball(24, 11);
  Isosurface isosurface_{image_, 1};
  Parameters parameters_{.delta_mm = kSpacing,
                         .sizes = SizeField({100, 100}),
                         .clamp_box = triangulator.mesh.box(),
                         .spacing_mm = kSpacing};
};

// Includes ratios between the published bound and sqrt(2 + sqrt(3)).
TEST(Invariants, HoldForTheNearestVertexThatR4MayInsert) {
  for (const double ratio : {1.93, 1.9301, 1.9305, 1.931, 1.9318, 1.94}) {
    NeedleInABall scene(ratio);
    EXPECT_EQ(scene.rule(), Rule::kR4) << ratio;
    scene.insert_center();
    std::string fault;
    EXPECT_TRUE(holds_invariants(scene.triangulator.mesh, kSpacing, kSlack, &fault)) << ratio << fault;
  }
}

TEST(Invariants, DoNotHoldForANearerOne) {
  NeedleInABall scene(kRadiusEdgeBound * (1 - 1e-5));
  EXPECT_FALSE(scene.rule());
  EXPECT_TRUE(holds_invariants(scene.triangulator.mesh, kSpacing, kSlack));
  scene.insert_center();
  std::string fault;
  EXPECT_FALSE(holds_invariants(scene.triangulator.mesh, kSpacing, kSlack, &fault));
  EXPECT_EQ(fault.substr(0, 2), "I2");
}

TEST(Invariants, HoldForASampleAsNearAsR3MayPutIt) {
  for (const double nearness : {1.0, kOneNearSample, kOneNearSample * (1 - 1e-5)}) {
    Triangulator triangulator({{-20, -20, -20}, {20, 20, 20}});
    triangulator.insert({0, 0, 0}, VertexKind::kIsosurface);
    triangulator.insert({nearness * kSpacing, 0, 0}, VertexKind::kIsosurface);
    std::string fault;
    EXPECT_EQ(holds_invariants(triangulator.mesh, kSpacing, kSlack, &fault), nearness >= kOneNearSample);
    EXPECT_EQ(fault.substr(0, 2), nearness >= kOneNearSample ? "" : "I1");
    EXPECT_EQ(least_sample_distance(triangulator.mesh, kSpacing), nearness * kSpacing);
  }
}

// Samples nearer than s let R4 insert vertices nearer, in proportion.
TEST(Invariants, HoldForR4BesideANearSample) {
  for (const double ratio : {1.93, 1.93 * (1 - 1e-5)}) {
    NeedleInABall scene(ratio);
    scene.insert_center();
    const double spacing = 1 / kOneNearSample;
    EXPECT_EQ(holds_invariants(scene.triangulator.mesh, spacing, kSlack), ratio == 1.93) << ratio;
  }
}

// The least circumradius of triangles with two sides of at least `ratio` and a third of at least 1.
double least_circumradius(double ratio) {
  constexpr int kSteps = 60;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const double a = ratio + 0.05 * i, b = ratio + 0.05 * j, c = 1 + 0.1 * k;
        const double squared_area = (a + b + c) * (a + b - c) * (c + a - b) * (c - a + b) / 16;
        if (squared_area > 0) least = std::min(least, a * b * c / (4 * std::sqrt(squared_area)));
      }
    }
  }
  return least;
}

TEST(Invariants, OfFacetsWithOneFreeVertexTheSmallestHasTheStatedCircumradius) {
  const double proven = least_circumradius(std::sqrt(2 + std::sqrt(3.0)));
  EXPECT_NEAR(proven, 1, 1e-12);
  const double published = least_circumradius(kRadiusEdgeBound);
  EXPECT_GE(published, kOneNearSample);
  EXPECT_LT(published, kOneNearSample + 2e-5);
}

}  // namespace
}  // namespace podm::test
