// Lines of an image with a flat box: which arcs are lines, and their exact points on the sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "isosurface/box_planes.h"
#include "lines/line_graph.h"
#include "lines/lines.h"
#include "lines/tests/line_images.h"
#include "lines/trace_lines.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::test {
namespace {

LabelImage flat_polycrystal(unsigned seed, std::array<double, 3> spacing = {1, 1, 1}) {
  Random random(seed);
  LabelImage image = polycrystal(random, {16, 15, 14}, spacing, 9, false);
  image.is_box_flat = true;
  return image;
}

LineNetwork traced(const LabelImage& image, const VoxelWeights* weights = nullptr) {
  return trace_lines(image, weights, {.has_lines = true, .is_box_flat = true, .threads = 2});
}

bool is_line(const LineArc& arc) { return arc.labels.size() >= kLabelsOfLine; }

TEST(LinesOnSides, APartOfANetworkHasItsArcsAndTheNodesAtTheirEnds) {
  const LineNetwork whole = traced(flat_polycrystal(1)), part = part_of(whole, is_line);
  std::vector<const LineArc*> wanted;
  for (const LineArc& arc : whole.arcs)
    if (is_line(arc)) wanted.push_back(&arc);
  ASSERT_EQ(part.arcs.size(), wanted.size());
  EXPECT_LT(part.arcs.size(), whole.arcs.size()) << "edges of the box between single grains";
  std::vector<bool> is_used(part.nodes.size());
  for (std::size_t a = 0; a < wanted.size(); ++a) {
    EXPECT_EQ(part.arcs[a].points, wanted[a]->points);
    ASSERT_EQ(part.arcs[a].is_closed(), wanted[a]->is_closed());
    if (part.arcs[a].is_closed()) continue;
    for (const auto& [n, point] : {std::pair(part.arcs[a].first_node, part.arcs[a].points.front()),
                                   std::pair(part.arcs[a].last_node, part.arcs[a].points.back())}) {
      EXPECT_EQ(part.nodes.at(static_cast<std::size_t>(n)).point, point);
      is_used[static_cast<std::size_t>(n)] = true;
    }
  }
  EXPECT_EQ(std::ranges::count(is_used, false), 0);
}

// All labels of an arc on a side but the background outside are around its points, which are in the plane to
// the bit.
TEST(LinesOnSides, ExactPointsAreInThePlanesAndBetweenTheLabels) {
  for (const double smoothing_mm : {0.0, 1.3}) {
    const LabelImage image = flat_polycrystal(2, {0.9, 1, 1.2});
    const auto weights = weights_of(image, smoothing_mm, 1);
    const Lines lines(part_of(traced(image, weights.get()), is_line), image, weights);
    const LabelFunction label(image, weights.get(), true);
    const BoxPlanes box(image);
    int num_found = 0, num_sought = 0;
    for (std::size_t a = 0; a < lines.num_arcs(); ++a) {
      const LineArc& arc = lines.network().arcs[a];
      if (std::popcount(arc.sides) != 1 || arc.labels.size() != 3) continue;
      const double length = lines.arc(a).length();
      for (double at = 2 * kShortArc; at < length - 2 * kShortArc; at += 0.3) {
        ++num_sought;
        const std::optional<SurfacePoint> p = lines.exact_point(a, at);
        if (!p) continue;
        ++num_found;
        EXPECT_EQ(p->sides, arc.sides);
        EXPECT_EQ(box.moved_onto(arc.sides, *p), *p);
        EXPECT_LT(distance(*p, lines.arc(a).point_at(at)), 0.05);
        std::set<LabelIndex> seen = label.labels_around(*p, 1e-6);
        seen.insert(kBackground);
        EXPECT_TRUE(std::includes(seen.begin(), seen.end(), arc.labels.begin(), arc.labels.end()));
      }
    }
    EXPECT_GT(num_sought, 300);
    EXPECT_GE(num_found, 0.99 * num_sought);
  }
}

TEST(LinesOnSides, ExactNodesAreInAllTheirPlanesAndBetweenTheLabels) {
  const LabelImage image = flat_polycrystal(3);
  const Lines lines(part_of(traced(image), is_line), image, nullptr);
  const LabelFunction label(image, nullptr, true);
  const BoxPlanes box(image);
  std::array<int, 3> num_on{};
  for (std::size_t n = 0; n < lines.network().nodes.size(); ++n) {
    const LineNode& node = lines.network().nodes[n];
    const std::optional<SurfacePoint> p = lines.exact_node(n);
    const auto num_sides = static_cast<std::size_t>(std::popcount(node.sides));
    if (num_sides == 0 || node.labels.size() != 5 - num_sides) continue;
    ASSERT_TRUE(p) << node.point.x << " " << node.point.y << " " << node.point.z;
    ASSERT_LT(num_sides, 3u);
    ++num_on[num_sides];
    EXPECT_EQ(p->sides, node.sides);
    EXPECT_EQ(box.moved_onto(node.sides, *p), *p);
    std::set<LabelIndex> seen = label.labels_around(*p, 1e-6);
    seen.insert(kBackground);
    EXPECT_TRUE(std::includes(seen.begin(), seen.end(), node.labels.begin(), node.labels.end()));
  }
  EXPECT_GT(num_on[1], 5);
  EXPECT_GT(num_on[2], 5);
}

// Where an arc from inside ends at a side, all its labels tie, although its last points are in the plane.
TEST(LinesOnSides, ExactPointsOfInnerArcsAreBetweenAllLabelsUpToThePlane) {
  constexpr double kFromEnd = 0.004;  // voxels
  const LabelImage image = flat_polycrystal(5);
  const Lines lines(part_of(traced(image), is_line), image, nullptr);
  const LabelFunction label(image, nullptr, true);
  int num_found = 0;
  for (std::size_t a = 0; a < lines.num_arcs(); ++a) {
    const LineArc& arc = lines.network().arcs[a];
    if (arc.sides != 0 || arc.labels.size() != 3 || arc.is_closed()) continue;
    for (const auto& [node, at] :
         {std::pair(arc.first_node, kFromEnd), std::pair(arc.last_node, lines.arc(a).length() - kFromEnd)}) {
      const SideMask sides = lines.network().nodes[static_cast<std::size_t>(node)].sides;
      if (std::popcount(sides) != 1) continue;
      const std::optional<SurfacePoint> p = lines.exact_point(a, at);
      ASSERT_TRUE(p);
      ++num_found;
      EXPECT_EQ(p->sides, sides);
      const std::set<LabelIndex> seen = label.labels_around(*p, 1e-6);
      EXPECT_TRUE(std::includes(seen.begin(), seen.end(), arc.labels.begin(), arc.labels.end()));
    }
  }
  EXPECT_GT(num_found, 10);
}

// One label in background has no line, and what tracing cannot decide about its curves is not reported.
TEST(LinesOnSides, CurvesOfTwoLabelsAreNoLines) {
  Random random(4);
  LabelImage image = random_image(random, {9, 9, 9}, {1, 1, 1}, 2, 0.5);
  image.is_box_flat = true;
  const LineNetwork network = traced(image);
  EXPECT_GT(network.arcs.size(), 50u);
  EXPECT_TRUE(part_of(network, is_line).is_empty());
  EXPECT_TRUE(network.undecided.empty());
  EXPECT_EQ(network.removed_voxels, 0);
}

}  // namespace
}  // namespace podm::test
