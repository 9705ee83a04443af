#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

std::uint64_t violations(const ClaimResult& result, const char* part) {
  return result.details().at("violations").value(part, std::uint64_t{0});
}

TEST(Structure, AcceptsSoundMeshes) {
  for (const Mesh& mesh :
       {corner(1, 2, 2), two_cells(), kuhn_cubes(3), shifted(kuhn_cubes(2), {0.1, 0.2, 0.3})}) {
    const ClaimResult result = structure_of(mesh);
    EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
    EXPECT_EQ(result.num_warnings, 0);
    EXPECT_TRUE(result.bad_cells.empty());
  }
}

TEST(Structure, RejectsAnEmptyMesh) {
  EXPECT_TRUE(names(check_structure({}, {}, two_threads()), "the mesh has cells"));
  EXPECT_TRUE(names(check_structure(mesh_of({{0, 0, 0}}, {}), {}, two_threads()), "the mesh has cells"));
}

TEST(Structure, RejectsIdsOutOfRange) {
  for (const VertexId id : {VertexId{5}, kNone}) {
    Mesh mesh = two_cells();
    mesh.cells[1][3] = id;
    const ClaimResult result = check_structure(mesh, {}, two_threads());
    EXPECT_TRUE(names(result, "vertex ids are in range"));
    EXPECT_EQ(result.bad_cells, std::vector<GlobalId>{1});
  }
}

TEST(Structure, RejectsCoordinatesThatAreNotFinite) {
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Mesh mesh = two_cells();
    mesh.vertices[4][1] = x;
    EXPECT_TRUE(names(check_structure(mesh, {}, two_threads()), "coordinates are finite"));
  }
}

TEST(Structure, DistinguishesInvertedFlatAndLeftHanded) {
  Mesh inverted = kuhn_cubes(2);
  std::swap(inverted.cells[7][1], inverted.cells[7][2]);
  ClaimResult result = structure_of(inverted);
  EXPECT_TRUE(names(result, "cells are positively oriented"));
  EXPECT_EQ(result.details()["negative_cells"], 1);
  EXPECT_FALSE(result.details()["is_left_handed"]);
  EXPECT_EQ(result.bad_cells, std::vector<GlobalId>{7});

  result = structure_of(two_cells({0.25, 0.25, 0}));
  EXPECT_TRUE(names(result, "no cell is flat"));
  EXPECT_EQ(result.details()["flat_cells"], 1);

  result = structure_of(turned_over(kuhn_cubes(2)));
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_TRUE(result.details()["is_left_handed"]);
  EXPECT_NE(result.reason.find("left-handed"), std::string::npos);
}

TEST(Structure, JudgesALeftHandedMeshAsItsMirrorImage) {
  const Mesh apart = joined(corner(1, 1, 1), shifted(corner(1, 1, 1), {2, 0, 0}));
  const Mesh overlapping = joined(corner(1, 1, 1), shifted(corner(1, 1, 1), {0.2, 0.1, 0.1}));
  for (const bool is_left_handed : {false, true}) {
    const auto judged = [&](const Mesh& mesh) {
      return structure_of(is_left_handed ? turned_over(mesh) : mesh);
    };
    EXPECT_EQ(violations(judged(apart), "overlap"), 0);
    EXPECT_GT(violations(judged(overlapping), "overlap"), 0);
  }
}

TEST(Structure, CountsACellListedTwiceOnce) {
  Mesh mesh = kuhn_cubes(2);
  for (const CellId c : {0U, 20U}) {  // at the boundary, and elsewhere
    Mesh twice = mesh;
    const auto& v = twice.cells[c];
    twice.cells.push_back({v[1], v[2], v[0], v[3]});
    const ClaimResult result = structure_of(twice);
    const auto is_duplicate = [](const Witness& w) {
      return w.statement == "no two cells have the same vertices";
    };
    EXPECT_EQ(std::count_if(result.worst.begin(), result.worst.end(), is_duplicate), 1);
  }
  EXPECT_TRUE(names(structure_of(mesh_of(corner(1, 1, 1).vertices, {{0, 1, 2, 3}, {1, 2, 0, 3}})),
                    "no two cells have the same vertices"));
}

TEST(Structure, RejectsThreeCellsOnAFacet) {
  Mesh mesh = two_cells();
  mesh.vertices.push_back({-1, -1, 2});
  mesh.cells.push_back({0, 1, 2, 5});
  EXPECT_TRUE(names(structure_of(mesh), "a facet has at most two cells"));
}

TEST(Structure, RejectsTwoCellsOnOneSideOfAFacet) {
  const Mesh mesh =
      mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {0, 1, 2, 4}});
  EXPECT_TRUE(names(structure_of(mesh), "the two cells of a facet are on opposite sides"));
}

TEST(Structure, RejectsCoincidentVertices) {
  const auto with_cell_at = [](const Point& p) {  // beyond the vertex (0, 1, 0) of the other
    const Mesh cell = mesh_of({p, {1, 2, 0}, {0, 3, 0}, {0, 2, 1}}, {{0, 1, 2, 3}});
    return structure_of(joined(corner(1, 1, 1), cell));
  };
  EXPECT_TRUE(names(with_cell_at({0, 1, 0}), "no two vertices have the same coordinates"));
  EXPECT_TRUE(names(with_cell_at({-0.0, 1, -0.0}), "no two vertices have the same coordinates"));
  EXPECT_EQ(with_cell_at({0, std::nextafter(1.0, 2.0), 0}).verdict, Verdict::kPass);
}

TEST(Structure, WarnsOfUnusedVertices) {
  Mesh mesh = kuhn_cubes(1);
  mesh.vertices.push_back({99, 99, 99});
  mesh.vertices.push_back({-0.5, 0, 0});  // on a facet, where a used vertex would hang
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.vertices.push_back({99, 99, 99});
  const ClaimResult result = structure_of(mesh);
  EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
  EXPECT_EQ(result.num_warnings, 4);
}

TEST(Structure, RejectsHangingVertices) {
  const auto with_tip_at = [](const Point& tip) {  // tip of a cell below the facet z = 0 of a corner
    const Mesh below = mesh_of({{0, 0, 0}, {1, 0, -1}, {0, 1, -1}, {-1, -1, -1}}, {{0, 2, 1, 3}});
    return structure_of(joined(corner(4, 4, 4), shifted(below, tip)));
  };
  EXPECT_EQ(violations(with_tip_at({1, 1, 0}), "hanging_vertices"), 1);  // inside the facet
  EXPECT_EQ(violations(with_tip_at({2, 2, 0}), "hanging_vertices"), 2);  // on an edge, so on two facets
  EXPECT_EQ(with_tip_at({1, 1, -1e-300}).verdict, Verdict::kPass);       // a little below
  EXPECT_EQ(with_tip_at({3, 2, 0}).verdict, Verdict::kPass);             // in the plane, beside the facet
  EXPECT_GT(violations(with_tip_at({1, 1, 0x1p-52}), "overlap"), 0);     // through the facet
}

// True if the insides of two cells meet: no axis among the normals of facets and the products of edges keeps
// them apart. Coordinates are small integers, so doubles are exact.
bool do_insides_meet(const std::array<Point, 4>& a, const std::array<Point, 4>& b) {
  const auto is_kept_apart = [&](const Vector<double>& axis) {
    if (dot(axis, axis) == 0) return false;
    const auto range = [&](const std::array<Point, 4>& cell) {
      std::array<double, 4> at{};
      for (std::size_t v = 0; v < 4; ++v) at[v] = dot(axis, cell[v]);
      return std::pair(*std::min_element(at.begin(), at.end()), *std::max_element(at.begin(), at.end()));
    };
    const auto [a_low, a_high] = range(a);
    const auto [b_low, b_high] = range(b);
    return a_high <= b_low || b_high <= a_low;
  };
  std::vector<Vector<double>> a_edges, b_edges;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      a_edges.push_back(difference<double>(a[i], a[j]));
      b_edges.push_back(difference<double>(b[i], b[j]));
    }
  for (const auto& edges :
       {std::pair(a_edges, a_edges), std::pair(b_edges, b_edges), std::pair(a_edges, b_edges)})
    for (const auto& u : edges.first)
      for (const auto& v : edges.second)
        if (is_kept_apart(cross(u, v))) return false;
  return true;
}

TEST(Structure, FindsExactlyTheOverlapsOfRandomCells) {
  std::mt19937 random(20);
  int num_overlapping = 0, num_apart = 0;
  for (int round = 0; round < 4000; ++round) {
    const bool is_merged = round % 2 == 0;  // equal points are one vertex, so facets can be shared
    std::array<std::array<Point, 4>, 3> cells;
    Mesh mesh;
    for (auto& cell : cells) {
      do {
        const auto points = lattice_points(4, 3, random);
        std::copy(points.begin(), points.end(), cell.begin());
      } while (rational_orientation(cell[0], cell[1], cell[2], cell[3]) <= 0);
      auto& ids = mesh.cells.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) {
        const auto known = std::find(mesh.vertices.begin(), mesh.vertices.end(), cell[k]);
        ids[k] = static_cast<VertexId>(is_merged ? known - mesh.vertices.begin()
                                                 : mesh.vertices.end() - mesh.vertices.begin());
        if (ids[k] == mesh.vertices.size()) mesh.vertices.push_back(cell[k]);
      }
    }
    const bool is_overlapping = do_insides_meet(cells[0], cells[1]) || do_insides_meet(cells[0], cells[2]) ||
                                do_insides_meet(cells[1], cells[2]);
    const ClaimResult result = structure_of(mesh);
    EXPECT_EQ(violations(result, "overlap") + violations(result, "facets") > 0, is_overlapping)
        << "round " << round;
    ++(is_overlapping ? num_overlapping : num_apart);
  }
  EXPECT_GT(num_overlapping, 100);
  EXPECT_GT(num_apart, 100);
}

TEST(Structure, AcceptsRandomTriangulationsAndNoCellInThem) {
  std::mt19937 random(21);
  for (int round = 0; round < 20; ++round) {
    Mesh mesh = delaunay_by_force(random_points(10, random));
    EXPECT_EQ(structure_of(mesh).verdict, Verdict::kPass);
    Point inside{};
    for (const VertexId v : mesh.cells[0])
      for (std::size_t a = 0; a < 3; ++a) inside[a] += mesh.vertices[v][a] / 4;
    EXPECT_GT(violations(structure_of(joined(mesh, shifted(corner(1e-9, 1e-9, 1e-9), inside))), "overlap"),
              0);
    mesh.cells.erase(mesh.cells.begin() + static_cast<std::ptrdiff_t>(mesh.cells.size() / 2));
    EXPECT_EQ(structure_of(mesh).verdict, Verdict::kPass) << "a hole is no fault of structure";
  }
}

TEST(Structure, DoesNotDependOnThreads) {
  std::mt19937 random(22);
  Mesh mesh = mesh_of(lattice_points(60, 5, random), {});
  std::uniform_int_distribution<VertexId> vertex(0, 59);
  for (int c = 0; c < 150; ++c)
    mesh.cells.push_back({vertex(random), vertex(random), vertex(random), vertex(random)});
  Mesh positive = mesh;
  std::erase_if(positive.cells, [&](auto& v) {
    return rational_orientation(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]],
                                mesh.vertices[v[3]]) <= 0;
  });
  for (const Mesh& m : {mesh, positive}) {
    const ClaimResult one = structure_of(m, 1);
    for (const int threads : {2, 3, 7}) {
      const ClaimResult many = structure_of(m, threads);
      EXPECT_EQ(many.details(), one.details());
      EXPECT_EQ(many.bad_cells, one.bad_cells);
      ASSERT_EQ(many.worst.size(), one.worst.size());
      for (std::size_t w = 0; w < one.worst.size(); ++w) {
        EXPECT_EQ(many.worst[w].statement, one.worst[w].statement);
        EXPECT_EQ(many.worst[w].cells, one.worst[w].cells);
        EXPECT_EQ(many.worst[w].vertices, one.worst[w].vertices);
      }
    }
  }
}

}  // namespace
}  // namespace podm::verify
