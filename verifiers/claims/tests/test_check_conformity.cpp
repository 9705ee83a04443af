#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "claims/claims.h"
#include "claims/tests/meshed_voxels.h"
#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

ClaimResult check(const Mesh& mesh, const Schedule* schedule = nullptr) {
  return check_conformity(mesh, find_adjacency(mesh, 1), schedule, Options{});
}

std::uint64_t count_of(const ClaimResult& result, const char* name) { return result.details().at(name); }

Mesh boxes() { return kuhn_mesh(make_image({12, 9, 8}, kUnitAffine, two_boxes)); }

// Gives the cells of `label` vertices of their own.
Mesh torn_off(Mesh mesh, LabelValue label) {
  std::map<VertexId, VertexId> copies;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.cell_labels[c] != label) continue;
    for (VertexId& v : mesh.cells[c]) {
      const auto [copy, is_new] = copies.try_emplace(v, static_cast<VertexId>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(Point(mesh.vertices[v]));
      v = copy->second;
    }
  }
  return mesh;
}

TEST(Conformity, SharedFacetsAreMatchedAndCopiedOnesAreNot) {
  EXPECT_EQ(check(boxes()).verdict, Verdict::kPass);
  const ClaimResult torn = check(torn_off(boxes(), 7));
  EXPECT_EQ(torn.verdict, Verdict::kFail);
  EXPECT_EQ(count_of(torn, "doubled_facets"), 5U * 4 * 2) << "two triangles a voxel of the face they share";
  EXPECT_EQ(count_of(torn, "doubled_vertices"), 6U * 5);
  EXPECT_EQ(torn.bad_cells.size(), 2U * 5 * 4 * 2) << "the cells on both sides";
}

TEST(Conformity, SidesThatShareNoFacetButVerticesAreFound) {
  Mesh mesh = torn_off(boxes(), 7);
  for (std::size_t v = boxes().vertices.size(); v < mesh.vertices.size(); ++v)
    mesh.vertices[v][1] = 8 - mesh.vertices[v][1];  // the diagonals of the shared face run the other way
  const ClaimResult result = check(mesh);
  EXPECT_EQ(count_of(result, "doubled_facets"), 0U);
  EXPECT_EQ(count_of(result, "doubled_vertices"), 6U * 5);
}

TEST(Conformity, ZerosOfBothSignsAreThePlace) {
  Mesh mesh = boxes();
  for (Point& p : mesh.vertices) p[0] -= 5.5;  // the shared face at x = 0
  mesh = torn_off(mesh, 7);
  for (std::size_t v = boxes().vertices.size(); v < mesh.vertices.size(); ++v)
    if (mesh.vertices[v][0] == 0) mesh.vertices[v][0] = -0.0;
  EXPECT_EQ(count_of(check(mesh), "doubled_vertices"), 6U * 5);
}

TEST(Conformity, AnUlpApartIsNotTheSamePlace) {
  Mesh mesh = torn_off(boxes(), 7);
  for (std::size_t v = boxes().vertices.size(); v < mesh.vertices.size(); ++v)
    mesh.vertices[v][0] = std::nextafter(mesh.vertices[v][0], 100);
  EXPECT_EQ(check(mesh).verdict, Verdict::kPass);
}

// Returns n^3 leaves of side 1 in the grid coordinates of the mesh.
Schedule unit_leaves(std::int64_t n) {
  Schedule schedule;
  schedule.mesh_to_grid = kUnitAffine;
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) schedule.leaves.push_back({{i, j, k}, 1});
  return schedule;
}

Activation active(std::uint32_t leaf, double begin_s, double end_s) {
  return {.leaf = leaf, .begin_s = begin_s, .end_s = end_s, .touched_leaves = {}};
}

ClaimResult check_active(Schedule schedule, std::vector<Activation> activations) {
  schedule.activations = std::move(activations);
  return check(boxes(), &schedule);
}

TEST(Conformity, VerticesAreLookedAtAlongLeafBoundaries) {
  const Schedule schedule = unit_leaves(8);
  const auto with_twins = [](const Point& p) {  // tips of two cells
    return joined(joined(boxes(), shifted(corner(0.1, 0.1, 0.1), p)), shifted(corner(-0.1, -0.1, -0.1), p));
  };
  const char* name = "doubled_vertices_at_leaf_boundaries";
  Mesh mesh = with_twins({3, 2.5, 2.5});
  EXPECT_EQ(count_of(check(mesh, &schedule), name), 1U);
  EXPECT_FALSE(check(mesh).details().contains(name)) << "without a schedule there are no leaves";
  mesh = with_twins({3 + 1e-9, 2.5, 2.5});
  EXPECT_EQ(count_of(check(mesh, &schedule), name), 1U) << "rounding does not hide it";
  mesh = with_twins({3.5, 2.5, 2.5});
  EXPECT_EQ(count_of(check(mesh, &schedule), name), 0U);
  mesh = boxes();
  mesh.vertices.insert(mesh.vertices.end(), 2, {3, 2.5, 2.5});
  EXPECT_EQ(check(mesh, &schedule).verdict, Verdict::kPass) << "no cell uses them";
}

TEST(Conformity, FacetsAtLeafBoundariesAreCounted) {
  Mesh mesh = boxes();  // corners of voxels at half integers
  Schedule schedule = unit_leaves(1);
  schedule.leaves = {{{0, 0, 0}, 16}};
  EXPECT_EQ(count_of(check(mesh, &schedule), "facets_at_leaf_boundaries"), 0U) << "all within one leaf";
  schedule.leaves = {{{-12, 0, 0}, 16}, {{4, 0, 0}, 16}};  // the plane x = 4 cuts one layer of 5 x 4 voxels
  const ClaimResult cut = check(mesh, &schedule);
  EXPECT_EQ(count_of(cut, "facets_at_leaf_boundaries_with_one_cell"), 2U * (5 + 4) * 2);
  const std::uint64_t within_voxels = 6, between_voxels = (6 * 4 + 5 * 5) - 2 * (5 + 4);
  EXPECT_EQ(count_of(cut, "facets_at_leaf_boundaries"),
            5 * 4 * within_voxels + 2 * between_voxels + 2U * (5 + 4) * 2);
  EXPECT_EQ(cut.verdict, Verdict::kPass);
}

TEST(Conformity, ActiveLeavesKeepTwoRingsApart) {
  const Schedule row = unit_leaves(8);  // leaves 0 to 7 along x
  EXPECT_EQ(check_active(row, {active(0, 0, 2), active(3, 1, 3)}).verdict, Verdict::kPass);
  for (const std::uint32_t near : {0U, 1U, 2U}) {
    const ClaimResult result = check_active(row, {active(0, 0, 2), active(near, 1, 3)});
    EXPECT_EQ(count_of(result, "active_leaves_too_near"), 1U) << near;
    EXPECT_EQ(result.worst.front().value, 1) << "seconds together";
  }
}

TEST(Conformity, RingsGoThroughLeavesOfAnySize) {
  Schedule schedule;
  schedule.mesh_to_grid = kUnitAffine;
  schedule.leaves = {{{0, 0, 0}, 1}, {{1, 1, 1}, 16}, {{17, 17, 17}, 1}, {{18, 18, 18}, 1}};
  EXPECT_EQ(check_active(schedule, {active(0, 0, 2), active(2, 1, 3)}).verdict, Verdict::kFail)
      << "both touch a corner of the large leaf between them";
  EXPECT_EQ(check_active(schedule, {active(0, 0, 2), active(3, 1, 3)}).verdict, Verdict::kPass);
  schedule.leaves[1].side = 1;
  EXPECT_EQ(check_active(schedule, {active(0, 0, 2), active(2, 1, 3)}).verdict, Verdict::kPass)
      << "no leaf between them";
}

TEST(Conformity, ActivationsEndBeforeOthersBeginAtTheSameTime) {
  const Schedule row = unit_leaves(4);
  EXPECT_EQ(check_active(row, {active(0, 0, 1), active(1, 1, 2)}).verdict, Verdict::kPass);
  EXPECT_EQ(check_active(row, {active(1, 1, 2), active(0, 0, std::nextafter(1, 2))}).verdict, Verdict::kFail);
  EXPECT_EQ(check_active(row, {active(0, 0, 2), active(1, 1, 1)}).verdict, Verdict::kFail)
      << "an instant within";
  EXPECT_EQ(check_active(row, {active(1, 0, 0), active(0, 0, 2)}).verdict, Verdict::kFail)
      << "at the beginning";
  EXPECT_EQ(check_active(row, {active(0, 0, 2), active(1, 2, 2)}).verdict, Verdict::kPass) << "at the end";
}

// Splits a cube of 32 at random into an octree's leaves.
void split(const Leaf& cube, std::mt19937& random, std::vector<Leaf>& leaves) {
  if (cube.side == 1 || (cube.side < 32 && random() % 3 == 0)) {
    leaves.push_back(cube);
    return;
  }
  const std::int64_t half = cube.side / 2;
  for (std::int64_t child = 0; child < 8; ++child)
    split({{cube.corner[0] + half * (child & 1), cube.corner[1] + half * ((child >> 1) & 1),
            cube.corner[2] + half * (child >> 2)},
           half},
          random, leaves);
}

// Counts by the definitions of rings and of being active together, word for word.
std::uint64_t pairs_too_near(const Schedule& schedule) {
  const auto touch = [&](const Leaf& p, const Leaf& q) {
    for (std::size_t a = 0; a < 3; ++a)
      if (p.corner[a] > q.corner[a] + q.side || q.corner[a] > p.corner[a] + p.side) return false;
    return true;
  };
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < schedule.activations.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Activation &a = schedule.activations[i], &b = schedule.activations[j];
      if (a.begin_s >= b.end_s || b.begin_s >= a.end_s) continue;
      const Leaf &p = schedule.leaves[a.leaf], &q = schedule.leaves[b.leaf];
      count += touch(p, q) || std::any_of(schedule.leaves.begin(), schedule.leaves.end(),
                                          [&](const Leaf& r) { return touch(p, r) && touch(r, q); });
    }
  }
  return count;
}

TEST(Conformity, RandomSchedulesAreJudgedByTheDefinition) {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    std::mt19937 random(seed);
    Schedule schedule;
    schedule.mesh_to_grid = kUnitAffine;
    split({{0, 0, 0}, 32}, random, schedule.leaves);
    for (int i = 0; i < 300; ++i) {
      const double begin_s = static_cast<double>(random() % 1000);
      schedule.activations.push_back(active(static_cast<std::uint32_t>(random() % schedule.leaves.size()),
                                            begin_s, begin_s + 1 + static_cast<double>(random() % 50)));
    }
    const std::uint64_t expected = pairs_too_near(schedule);
    EXPECT_GT(expected, 0U);
    EXPECT_EQ(count_of(check(boxes(), &schedule), "active_leaves_too_near"), expected) << "seed " << seed;
  }
}

TEST(Conformity, OperationsKeepToTheFirstRing) {
  Schedule schedule = unit_leaves(4);
  Activation a = active(0, 0, 1);
  a.touched_leaves = {0, 1, 4, 16, 21};  // itself, three leaves that share a face, the far corner of ring 1
  EXPECT_EQ(check_active(schedule, {a}).verdict, Verdict::kPass);
  a.touched_leaves.push_back(2);
  const ClaimResult result = check_active(schedule, {a});
  EXPECT_EQ(count_of(result, "leaves_touched_outside"), 1U);
}

TEST(Conformity, LeavesDoNotOverlap) {
  Schedule schedule = unit_leaves(4);
  EXPECT_EQ(check_active(schedule, {}).verdict, Verdict::kPass) << "leaves that touch do not overlap";
  schedule.leaves.push_back({{2, 2, 2}, 2});
  const ClaimResult result = check_active(schedule, {});
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_EQ(count_of(result, "overlapping_leaves"), 9U) << "the large one and the eight within";
}

TEST(Conformity, LargeSchedulesTakeNoQuadraticTime) {  // checked by the time limit of the tests
  Schedule schedule = unit_leaves(47);                 // 103823 leaves
  std::vector<Activation> activations;
  for (std::uint32_t i = 0; i < 100000; ++i) activations.push_back(active(i, i, i + 1));
  EXPECT_EQ(check_active(schedule, activations).verdict, Verdict::kPass);
  for (Activation& a : activations) a = active(5, a.begin_s / 1e6, 1);
  EXPECT_EQ(count_of(check_active(schedule, activations), "active_leaves_too_near"), 100000ULL * 99999 / 2);
}

TEST(Conformity, ManySmallLeavesAroundALargeOneTakeNoQuadraticTime) {
  constexpr std::int64_t kSide = 128;
  Schedule schedule = unit_leaves(0);
  schedule.leaves.push_back({{0, 0, 0}, kSide});
  for (std::int64_t k = -1; k <= kSide; ++k)
    for (std::int64_t j = -1; j <= kSide; ++j)
      for (std::int64_t i = -1; i <= kSide; ++i)
        if (std::min({i, j, k}) < 0 || std::max({i, j, k}) == kSide)
          schedule.leaves.push_back({{i, j, k}, 1});
  ASSERT_GT(schedule.leaves.size(), 98000U);
  std::vector<Activation> activations;
  for (std::uint32_t i = 0; i < schedule.leaves.size(); ++i) activations.push_back(active(i, i, i + 1));
  EXPECT_EQ(check_active(schedule, activations).verdict, Verdict::kPass);
  activations[0].end_s = 2.5;  // the large leaf is active while the first two small ones are
  EXPECT_EQ(count_of(check_active(schedule, activations), "active_leaves_too_near"), 2U);
}

}  // namespace
}  // namespace podm::verify
