#include "lines/trace_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "image/working_frame.h"
#include "isosurface/isosurface.h"
#include "lines/arc.h"
#include "lines/chains.h"
#include "lines/line_graph.h"
#include "lines/polyline.h"
#include "lines/tests/line_images.h"
#include "podm/errors.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::test {
namespace {

struct Traced {
  LabelImage image;
  std::shared_ptr<const VoxelWeights> weights;
  bool is_box_flat;
  LineNetwork network;
};

Traced traced(LabelImage image, double smoothing_mm, bool is_box_flat, bool has_lines = true) {
  Traced t{std::move(image), nullptr, is_box_flat, {}};
  t.weights = weights_of(t.image, smoothing_mm, 2);
  t.network = trace_lines(t.image, t.weights.get(),
                          {.has_lines = has_lines, .is_box_flat = is_box_flat, .threads = 2});
  return t;
}

// Polycrystals cut by the box or within a margin, smoothed or not, in an open or a flat box.
const std::vector<Traced>& polycrystals() {
  static std::vector<Traced> all;
  if (!all.empty()) return all;
  Random random(20);
  for (const double smoothing_mm : {0.0, 1.5})
    for (const bool is_box_flat : {false, true})
      for (const bool has_margin : {false, true})
        all.push_back(traced(polycrystal(random, {26, 22, 24}, {1, 1, 1}, has_margin ? 6 : 14, has_margin),
                             smoothing_mm, is_box_flat));
  all.push_back(traced(polycrystal(random, {20, 20, 9}, {0.7, 0.7, 2}, 10, false), 1, true));
  return all;
}

LabelImage noise(Random& random, std::array<int, 3> size, unsigned num_labels, double coherence) {
  LabelImage image = random_image(random, size, {1, 1, 1}, num_labels, coherence);
  image.labels.resize(num_labels);
  return image;
}

double distance_to_nodes(const LineNetwork& network, const Point& p) {
  double least = 1e300;
  for (const LineNode& node : network.nodes) least = std::min(least, distance(node.point, p));
  return least;
}

double distance_to_undecided(const LineNetwork& network, const Point& p) {
  double least = 1e300;
  for (const UndecidedPlace& place : network.undecided) least = std::min(least, distance(place.point, p));
  return least;
}

bool see_all(const std::set<LabelIndex>& seen, const std::vector<LabelIndex>& labels) {
  return std::includes(seen.begin(), seen.end(), labels.begin(), labels.end());
}

TEST(TraceLines, ArcsEndAtTheirNodesAndClosedArcsClose) {
  for (const Traced& t : polycrystals()) {
    for (const LineArc& arc : t.network.arcs) {
      ASSERT_GE(arc.points.size(), 2u);
      EXPECT_TRUE(std::is_sorted(arc.labels.begin(), arc.labels.end()));
      for (std::size_t i = 0; i + 1 < arc.points.size(); ++i)
        EXPECT_GT(distance(arc.points[i], arc.points[i + 1]), 5e-4);
      if (arc.is_closed()) {
        EXPECT_EQ(arc.last_node, -1);
        EXPECT_EQ(arc.points.front(), arc.points.back());
        EXPECT_GE(arc.points.size(), 4u);
        continue;
      }
      for (const auto& [n, point] :
           {std::pair(arc.first_node, arc.points.front()), std::pair(arc.last_node, arc.points.back())}) {
        const LineNode& node = t.network.nodes.at(static_cast<std::size_t>(n));
        EXPECT_EQ(node.point, point);
        EXPECT_EQ(node.sides & arc.sides, arc.sides);
        EXPECT_TRUE(
            std::includes(node.labels.begin(), node.labels.end(), arc.labels.begin(), arc.labels.end()));
      }
    }
  }
}

// Each interface that ends in an arc goes on in others at the node: no label has one arc there, or three.
TEST(TraceLines, NoCurveEndsInside) {
  for (const Traced& t : polycrystals()) {
    const std::vector<int> degree = degrees(t.network);
    for (std::size_t n = 0; n < degree.size(); ++n) {
      EXPECT_GE(degree[n], 3) << t.network.nodes[n].point.x;
      if (t.network.nodes[n].sides == 0) {
        EXPECT_GE(t.network.nodes[n].labels.size(), 4u);
      }
    }
    for (const LineArc& arc : t.network.arcs) EXPECT_GE(arc.labels.size(), arc.sides == 0 ? 3u : 2u);
  }
}

// Where only curves of three labels meet, at least four do, and each pair of labels is met by curves an even
// number of times: an interface that a curve bounds is bounded by another.
TEST(TraceLines, FourCurvesOfThreeLabelsMeet) {
  int num_nodes = 0;
  for (const Traced& t : polycrystals()) {
    std::map<std::int32_t, std::vector<const LineArc*>> arcs_at;
    for (const LineArc& arc : t.network.arcs) {
      arcs_at[arc.first_node].push_back(&arc);
      arcs_at[arc.last_node].push_back(&arc);
    }
    for (const auto& [n, arcs] : arcs_at) {
      const bool is_plain = std::all_of(arcs.begin(), arcs.end(), [](const LineArc* arc) {
        return arc->sides == 0 && arc->labels.size() == 3;
      });
      if (n < 0 || !is_plain) continue;
      ++num_nodes;
      EXPECT_GE(arcs.size(), 4u);
      std::map<std::pair<LabelIndex, LabelIndex>, int> interfaces;
      for (const LineArc* arc : arcs)
        for (std::size_t i = 0; i < 3; ++i)
          ++interfaces[std::minmax(arc->labels[i], arc->labels[(i + 1) % 3])];
      for (const auto& [pair, count] : interfaces) EXPECT_EQ(count % 2, 0);
    }
  }
  EXPECT_GT(num_nodes, 100);
}

// Away from nodes and from the places that are listed.
TEST(TraceLines, AllLabelsOfAnArcMeetAlongIt) {
  std::size_t num_points = 0;
  for (const Traced& t : polycrystals()) {
    const LabelFunction label(t.image, t.weights.get(), t.is_box_flat);
    const double side = *std::max_element(t.image.spacing.begin(), t.image.spacing.end());
    for (const LineArc& arc : t.network.arcs) {
      if (arc.sides != 0) continue;
      const bool is_merged = arc.labels.size() > 3;
      for (std::size_t i = 0; i + 1 < arc.points.size(); i += 4) {
        const Point& p = arc.points[i];
        const Point middle = p + 0.5 * (arc.points[i + 1] - p);
        if (distance_to_nodes(t.network, p) < 2 * kShortArc * side ||
            distance_to_undecided(t.network, p) < 0.5 * side)
          continue;
        EXPECT_TRUE(see_all(label.labels_around(p, is_merged ? 2 * kMergeDistance : 0.01), arc.labels));
        EXPECT_TRUE(see_all(label.labels_around(middle, is_merged ? 2 * kMergeDistance : 0.04), arc.labels))
            << t.image.size[0] << " flat " << t.is_box_flat << " w " << (t.weights != nullptr) << " labels "
            << arc.labels.size() << " " << p.x << " " << p.y << " " << p.z << " to " << arc.points[i + 1].x
            << " " << arc.points[i + 1].y << " " << arc.points[i + 1].z << " nodes "
            << distance_to_nodes(t.network, p) << " " << distance_to_nodes(t.network, middle);
        ++num_points;
      }
    }
  }
  EXPECT_GT(num_points, 2000u);
}

TEST(TraceLines, TheIsosurfaceSeesAllLabelsOfAnArc) {
  Random random(3);
  for (const double smoothing_mm : {0.0, 1.2}) {
    const Traced t =
        traced(polycrystal(random, {20, 24, 22}, {0.8, 0.9, 1.1}, 9, false), smoothing_mm, false);
    const Isosurface isosurface(t.image, 2, t.weights);
    for (const LineArc& arc : t.network.arcs) {
      if (arc.labels.size() > 3) continue;
      for (const Point& p : arc.points) {
        if (distance_to_nodes(t.network, p) < 0.6 || distance_to_undecided(t.network, p) < 0.5) continue;
        std::set<LabelIndex> seen;
        for (int sample = 0; sample < 600; ++sample) {
          Vector d{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
          seen.insert(isosurface.label_at(p + 0.02 * d));
        }
        EXPECT_TRUE(see_all(seen, arc.labels));
      }
    }
  }
}

// Looks for places where three labels meet by sampling cubes of 1/12 voxel, and for each asks for an arc or a
// listed place nearby.
void expect_all_found(const Traced& t) {
  constexpr int kPerVoxel = 12;
  const LabelFunction label(t.image, t.weights.get(), t.is_box_flat);
  const auto count = [&](std::size_t a) { return (t.image.size[a] + 1) * kPerVoxel + 1; };
  const double first = t.is_box_flat ? -0.5 : -1, offset = 0.01;
  const auto coordinate = [&](int i) { return first + (i + offset) / kPerVoxel; };
  const auto end = [&](std::size_t a) {
    return t.is_box_flat ? t.image.size[a] - 0.5 : t.image.size[a] + 0.0;
  };
  const auto nx = static_cast<std::size_t>(count(0)), ny = static_cast<std::size_t>(count(1));
  std::vector<LabelIndex> below(nx * ny), above(nx * ny);
  std::size_t num_places = 0, num_far = 0;
  for (int k = 0; k < count(2) && coordinate(k) < end(2); ++k) {
    below.swap(above);
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i)
        above[j * nx + i] =
            label({coordinate(static_cast<int>(i)), coordinate(static_cast<int>(j)), coordinate(k)});
    if (k == 0) continue;
    for (int j = 0; j + 1 < count(1) && coordinate(j + 1) < end(1); ++j)
      for (int i = 0; i + 1 < count(0) && coordinate(i + 1) < end(0); ++i) {
        const std::size_t at = static_cast<std::size_t>(j) * nx + static_cast<std::size_t>(i);
        std::array<LabelIndex, 8> labels{below[at], below[at + 1], below[at + nx], below[at + nx + 1],
                                         above[at], above[at + 1], above[at + nx], above[at + nx + 1]};
        std::sort(labels.begin(), labels.end());
        if (std::unique(labels.begin(), labels.end()) - labels.begin() < 3) continue;
        ++num_places;
        const double half = 0.5 / kPerVoxel;
        const Point u{coordinate(i) + half, coordinate(j) + half, coordinate(k) - half};
        const auto& s = t.image.spacing;
        const Point p{u.x * s[0], u.y * s[1], u.z * s[2]};
        const double reach = kFoundDistance * *std::max_element(s.begin(), s.end()) + 0.1;
        if (distance_to_arcs(t.network, p) > 0.15 * s[0]) ++num_far;
        EXPECT_LT(std::min(distance_to_arcs(t.network, p), distance_to_undecided(t.network, p)), reach);
      }
  }
  EXPECT_GT(num_places, 500u);
  EXPECT_LT(num_far, num_places / 20);
}

TEST(TraceLines, EveryPlaceWhereThreeLabelsMeetIsFoundOrListed) {
  Random random(4);
  for (const double smoothing_mm : {0.0, 1.0})
    for (const bool is_box_flat : {false, true}) {
      expect_all_found(
          traced(polycrystal(random, {11, 12, 10}, {1, 1, 1}, 5, false), smoothing_mm, is_box_flat));
      expect_all_found(traced(noise(random, {6, 5, 6}, 4, 0.6), smoothing_mm, is_box_flat));
    }
}

TEST(TraceLines, ThreeSectorsMeetInAStraightLine) {
  const Point center{14.3, 13.8, 14.6};
  const Vector direction{0.3, 0.2, 1};
  const Traced t = traced(sectors({29, 29, 29}, 3, center, direction), 2, true);
  const LineArc* found = nullptr;
  for (const LineArc& arc : t.network.arcs) {
    if (arc.sides != 0) continue;
    EXPECT_EQ(found, nullptr) << "one line";
    found = &arc;
  }
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->labels, (std::vector<LabelIndex>{1, 2, 3}));
  const double slope = std::sqrt(squared_length(direction));
  EXPECT_NEAR(Arc(*found).length(), 29 * slope, 0.06 * 29 * slope);
  for (const Point& p : found->points)
    EXPECT_LT(std::sqrt(squared_length(cross(p - center, direction))) / slope, 0.6);
  for (const auto n : {found->first_node, found->last_node})
    EXPECT_EQ(std::popcount(t.network.nodes[static_cast<std::size_t>(n)].sides), 1);
}

TEST(TraceLines, FourSectorsMeetInOneLineOfFourLabels) {
  for (const bool is_box_flat : {false, true}) {
    const Traced t = traced(sectors({12, 12, 12}, 4, {5.5, 5.5, 5.5}, {0, 0, 1}), 0, is_box_flat);
    int num_lines = 0;
    for (const LineArc& arc : t.network.arcs) {
      if (arc.labels.size() != 4) continue;
      ++num_lines;
      EXPECT_EQ(arc.labels, (std::vector<LabelIndex>{1, 2, 3, 4}));
      for (const Point& p : arc.points)
        EXPECT_NEAR(std::max(std::fabs(p.x - 5.5), std::fabs(p.y - 5.5)), 0, 1e-9);
      EXPECT_NEAR(Arc(arc).length(), is_box_flat ? 12 : 12 - 2. / 3, 0.5);
    }
    EXPECT_EQ(num_lines, 1);
    EXPECT_TRUE(t.network.undecided.empty());
  }
}

// Two overlapping spheres in background: their interface ends in a circle.
TEST(TraceLines, TwoSpheresMeetInACircle) {
  const Point a{12, 14.2, 14.4}, b{19, 14.2, 14.4};
  const double radius = 9, middle = 0.5 * (a.x + b.x), of_circle = std::sqrt(81 - 3.5 * 3.5);
  const Traced t = traced(image_of({32, 30, 30}, {1, 1, 1}, 3,
                                   [&](const Point& p) -> LabelIndex {
                                     const double to_a = distance(p, a), to_b = distance(p, b);
                                     return std::min(to_a, to_b) > radius ? 0 : to_a < to_b ? 1 : 2;
                                   }),
                          2, false);
  ASSERT_EQ(t.network.arcs.size(), 1u);
  const LineArc& circle = t.network.arcs[0];
  EXPECT_TRUE(circle.is_closed());
  EXPECT_EQ(circle.labels, (std::vector<LabelIndex>{0, 1, 2}));
  EXPECT_NEAR(Arc(circle).length(), 2 * std::numbers::pi * of_circle,
              0.04 * 2 * std::numbers::pi * of_circle);
  for (const Point& p : circle.points) {
    EXPECT_NEAR(p.x, middle, 0.3);
    EXPECT_NEAR(std::hypot(p.y - a.y, p.z - a.z), of_circle, 0.7);
  }
  EXPECT_TRUE(t.network.nodes.empty());
}

bool are_equal(const LineNetwork& a, const LineNetwork& b) {
  const auto same_arc = [](const LineArc& x, const LineArc& y) {
    return x.points == y.points && x.first_node == y.first_node && x.last_node == y.last_node &&
           x.labels == y.labels && x.sides == y.sides;
  };
  const auto same_node = [](const LineNode& x, const LineNode& y) {
    return x.point == y.point && x.sides == y.sides && x.labels == y.labels;
  };
  const auto same_place = [](const UndecidedPlace& x, const UndecidedPlace& y) {
    return x.block == y.block && x.point == y.point && x.reason == y.reason;
  };
  return std::equal(a.arcs.begin(), a.arcs.end(), b.arcs.begin(), b.arcs.end(), same_arc) &&
         std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), same_node) &&
         std::equal(a.undecided.begin(), a.undecided.end(), b.undecided.begin(), b.undecided.end(),
                    same_place);
}

TEST(TraceLines, NoiseIsTracedAlikeOnAnyNumberOfThreads) {
  Random random(5);
  for (const std::array<int, 3> size : {std::array{7, 9, 8}, std::array{1, 6, 5}, std::array{12, 1, 1},
                                        std::array{1, 1, 1}, std::array{3, 2, 14}})
    for (const unsigned num_labels : {2u, 4u, 40u})
      for (const bool is_box_flat : {false, true}) {
        const LabelImage image = noise(random, size, num_labels, 0.3);
        const auto weights = random_weights(random, image);
        for (const VoxelWeights* w : {static_cast<const VoxelWeights*>(nullptr), weights.get()}) {
          const LineNetwork one =
              trace_lines(image, w, {.has_lines = true, .is_box_flat = is_box_flat, .threads = 1});
          for (const int threads : {2, 5})
            EXPECT_TRUE(are_equal(
                one,
                trace_lines(image, w, {.has_lines = true, .is_box_flat = is_box_flat, .threads = threads})));
          for (const LineArc& arc : one.arcs)
            for (const std::int32_t n : {arc.first_node, arc.last_node})
              ASSERT_LT(n, static_cast<std::int32_t>(one.nodes.size()));
        }
      }
}

// With a flat box the edges of the box that touch foreground are arcs; their lengths add up to those of the
// runs of foreground along each edge.
TEST(TraceLines, EdgesOfAFlatBoxAreArcs) {
  const Traced t =
      traced(image_of({9, 8, 7}, {1, 2, 0.5}, 2, [](const Point&) { return LabelIndex{1}; }), 0, true, false);
  EXPECT_EQ(t.network.nodes.size(), 8u);
  EXPECT_EQ(t.network.arcs.size(), 12u);
  double length = 0;
  for (const LineArc& arc : t.network.arcs) {
    EXPECT_EQ(std::popcount(arc.sides), 2);
    EXPECT_EQ(arc.labels, (std::vector<LabelIndex>{0, 1}));
    length += Arc(arc).length();
  }
  EXPECT_DOUBLE_EQ(length, 4 * (9 + 16 + 3.5));
  for (const LineNode& node : t.network.nodes) EXPECT_EQ(std::popcount(node.sides), 3);
}

// The plane of a side, in the frame's axes: the coordinate that all its points share.
TEST(TraceLines, PointsOnSidesLieExactlyInTheirPlanes) {
  Random random(6);
  LabelImage image = polycrystal(random, {14, 12, 13}, {0.3, 0.7, 1.1}, 12, false);
  image.voxel_to_ras = {0, -0.7, 0, 31.1, 0, 0, 1.1, -7.3, 0.3, 0, 0, 0.123};  // permuted and mirrored
  const Affine to_mm = voxels_to_working(image);
  const LineNetwork network = trace_lines(image, nullptr, {.has_lines = true, .is_box_flat = true});
  const std::array<std::size_t, 3> row_of_axis{2, 0, 1};
  int num_points = 0;
  for (const LineArc& arc : network.arcs)
    for (unsigned side = 0; side < 6; ++side) {
      if ((arc.sides >> side & 1) == 0) continue;
      const std::size_t axis = side / 2;
      std::array<double, 3> on_plane{1.7, 2.9, 3.1};  // any point of the plane
      on_plane[axis] = side % 2 == 0 ? -0.5 : image.size[axis] - 0.5;
      const double plane = map(to_mm, on_plane)[row_of_axis[axis]];
      for (const Point& p : arc.points) {
        EXPECT_EQ((std::array{p.x, p.y, p.z})[row_of_axis[axis]], plane);
        ++num_points;
      }
    }
  EXPECT_GT(num_points, 300);
}

// On a side two labels meet along an arc. Lines of three labels end there at nodes.
TEST(TraceLines, LabelsMeetAlongArcsOnSides) {
  Random random(7);
  for (const double smoothing_mm : {0.0, 1.5}) {
    const Traced t = traced(polycrystal(random, {20, 20, 20}, {1, 1, 1}, 10, false), smoothing_mm, true);
    const LabelFunction label(t.image, t.weights.get(), true);
    std::size_t num_points = 0;
    for (const LineArc& arc : t.network.arcs) {
      if (std::popcount(arc.sides) != 1) continue;
      EXPECT_TRUE(arc.labels.size() == 3 && arc.labels[0] == kBackground);
      for (std::size_t i = 0; i + 1 < arc.points.size(); ++i) {
        const Point middle = arc.points[i] + 0.5 * (arc.points[i + 1] - arc.points[i]);
        if (distance_to_nodes(t.network, middle) < 2 * kShortArc) continue;
        std::set<LabelIndex> seen = label.labels_around(middle, 0.04);
        seen.insert(kBackground);  // outside
        EXPECT_TRUE(see_all(seen, arc.labels));
        ++num_points;
      }
    }
    EXPECT_GT(num_points, 300u);
    for (const LineArc& arc : t.network.arcs)
      for (const std::int32_t n : {arc.first_node, arc.last_node}) {
        if (arc.sides != 0 || n < 0) continue;
        const LineNode& node = t.network.nodes[static_cast<std::size_t>(n)];
        const Point u = to_index(t.image, node.point);
        const bool is_at_border = std::min({u.x, u.y, u.z}) < 0 || std::max({u.x, u.y, u.z}) > 19;
        EXPECT_EQ(node.sides != 0, is_at_border);
      }
  }
}

// Checkerboards on a side: two curves that cross there share a node.
TEST(TraceLines, CurvesThatCrossOnASideShareANode) {
  const Traced t = traced(image_of({4, 4, 4}, {1, 1, 1}, 3,
                                   [](const Point& p) { return LabelIndex(1 + ((p.x < 2) != (p.y < 2))); }),
                          0, true, false);
  int num_crossings = 0;
  const std::vector<int> degree = degrees(t.network);
  for (std::size_t n = 0; n < degree.size(); ++n)
    if (std::popcount(t.network.nodes[n].sides) == 1) {
      EXPECT_EQ(degree[n], 4);
      EXPECT_NEAR(distance(t.network.nodes[n].point, {1.5, 1.5, t.network.nodes[n].point.z}), 0, 0.02);
      ++num_crossings;
    }
  EXPECT_EQ(num_crossings, 2);
}

TEST(TraceLines, OnlyCurvesOfThreeCountingLabelsAreTraced) {
  Random random(8);
  const LabelImage image = polycrystal(random, {18, 18, 18}, {1, 1, 1}, 8, true);
  std::vector<bool> counts(9, true);
  counts[3] = counts[5] = false;
  const LineNetwork all = trace_lines(image, nullptr, {.has_lines = true});
  const LineNetwork some = trace_lines(image, nullptr, {.has_lines = true, .counts = counts});
  const auto counting = [&](const LineArc& arc) {
    return std::count_if(arc.labels.begin(), arc.labels.end(), [&](LabelIndex l) { return counts[l]; });
  };
  double length_of_counting = 0, length_of_some = 0;
  for (const LineArc& arc : all.arcs)
    if (counting(arc) >= 3) length_of_counting += Arc(arc).length();
  for (const LineArc& arc : some.arcs) {
    EXPECT_GE(counting(arc), 3);
    length_of_some += Arc(arc).length();
  }
  EXPECT_NEAR(length_of_some, length_of_counting, 0.02 * length_of_counting);
  EXPECT_LT(some.arcs.size(), all.arcs.size());
}

// A label of one voxel with least weights on an interface is smaller than the lattice: its curve is too
// short.
TEST(TraceLines, FeaturesBelowTheLatticeAreListed) {
  const LabelImage image = image_of({7, 7, 7}, {1, 1, 1}, 4, [](const Point& p) -> LabelIndex {
    return p == Point{3, 3, 3} ? 3 : p.x < 3.5 ? 1 : 2;
  });
  auto weights = std::make_shared<VoxelWeights>(image.size);
  for (std::size_t v = 0; v < image.num_voxels(); ++v) weights->at(v) = VoxelWeights::kMost;
  weights->at(image.index(3, 3, 3)) = VoxelWeights::kMost / 100;
  weights->at(image.index(4, 3, 3)) = VoxelWeights::kMost / 100;
  const LineNetwork network = trace_lines(image, weights.get(), {.has_lines = true});
  const bool is_listed = std::any_of(network.undecided.begin(), network.undecided.end(), [](const auto& u) {
    return distance(u.point, {3.5, 3, 3}) < 1;
  });
  const bool is_traced = std::any_of(network.arcs.begin(), network.arcs.end(), [](const LineArc& arc) {
    return std::binary_search(arc.labels.begin(), arc.labels.end(), 3);
  });
  EXPECT_TRUE(is_listed || is_traced);
}

TEST(TraceLines, EndsWithoutLinesOnceTheRunIsOver) {
  Random random(31);
  const LabelImage image = noise(random, {20, 20, 20}, 5, 0.3);
  constexpr int kMost = 3;
  std::atomic<int> num_traced = 0;
  const LineNetwork network = trace_lines(
      image, nullptr, {.has_lines = true, .threads = 2, .is_over = [&] { return ++num_traced > kMost; }});
  EXPECT_TRUE(network.is_empty());
  EXPECT_FALSE(network.is_whole);
  EXPECT_TRUE(trace_lines(image, nullptr, {.has_lines = true}).is_whole);
}

TEST(TraceLines, RefusesWhatItCannotDo) {
  Random random(9);
  LabelImage image = noise(random, {10, 10, 10}, 5, 0);
  EXPECT_THROW(trace_lines(image, nullptr, {.has_lines = true, .most_bytes = 1 << 20}), InputError);
  EXPECT_NO_THROW(trace_lines(image, nullptr, {.has_lines = true, .most_bytes = 1 << 30}));
  image.voxel_to_ras = {1, 0.2, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  image.spacing[1] = std::hypot(1, 0.2);
  EXPECT_THROW(trace_lines(image, nullptr, {.is_box_flat = true}), InputError);
  EXPECT_NO_THROW(trace_lines(image, nullptr, {.has_lines = true}));
}

}  // namespace
}  // namespace podm::test
