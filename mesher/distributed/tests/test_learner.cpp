// Threads that learn vertices together make the Delaunay triangulation of these vertices.
#include "distributed/learner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "delaunay/tests/cells_by_points.h"
#include "delaunay/tests/point_sets.h"
#include "delaunay/tests/triangulator.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "refine/virtual_box.h"
#include "tests/images.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

class Learners : public testing::Test {
 protected:
  // A rank's store, which is empty at first, and its learner.
  struct Rank {
    Rank(const Problem& problem, const CubeGrid& grid, int threads, OperationLogWriter* log = nullptr)
        : team{.coordination = {.num_workers = threads}, .log = log},
          construction(problem, clamp_box(problem.object, problem.delta_mm), team, stop),
          learner(construction, grid) {}
    Mesh& mesh() { return construction.mesh(); }

    StopControl stop{{}, {}, [](std::uint64_t) {}};
    Team team;
    Construction construction;
    Learner learner;
  };

  std::vector<LearntVertex> drawn_vertices(std::size_t count, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    const Box& box = problem_.object;
    const auto draw = [&](double low, double high) {
      return std::uniform_real_distribution(low, high)(random);
    };
    std::vector<LearntVertex> vertices;
    for (std::size_t i = 0; i < count; ++i)
      vertices.push_back(
          {{draw(box.low.x, box.high.x), draw(box.low.y, box.high.y), draw(box.low.z, box.high.z)},
           i % 3 == 0 ? VertexKind::kIsosurface : VertexKind::kCircumcenter});
    return vertices;
  }

  static void expect_lists_new_cells(const Mesh& mesh, const std::vector<LearntVertex>& learnt,
                                     std::vector<CellId> made) {
    std::set<std::array<double, 3>> points;
    for (const LearntVertex& vertex : learnt) points.insert({vertex.point.x, vertex.point.y, vertex.point.z});
    std::sort(made.begin(), made.end());
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      const Cell& cell = mesh.cell(c);
      if (!cell.is_alive()) continue;
      const bool is_new = std::any_of(cell.vertices.begin(), cell.vertices.end(), [&](VertexId v) {
        const Point& p = mesh.point(v);
        return points.contains({p.x, p.y, p.z});
      });
      EXPECT_TRUE(!is_new || std::binary_search(made.begin(), made.end(), c)) << "cell " << c;
    }
  }

  // Every other vertex of the first half goes, the second half comes.
  static std::vector<LearntVertex> changes_of(const std::vector<LearntVertex>& vertices) {
    std::vector<LearntVertex> changes(vertices.begin() + static_cast<std::ptrdiff_t>(vertices.size() / 2),
                                      vertices.end());
    for (std::size_t i = 0; i < vertices.size() / 2; i += 2)
      changes.push_back({vertices[i].point, VertexKind::kUnused});
    return changes;
  }

  const LabelImage image_ = ball(20, 7);
  const Isosurface isosurface_{image_, 1};
  const Problem problem_{.isosurface = isosurface_,
                         .object = foreground_bounds(image_),
                         .delta_mm = 1,
                         .sizes = SizeField(std::vector<double>(image_.labels.size(), 2.0)),
                         .cell_capacity = 1 << 20};
  const CubeGrid grid_{problem_.object, 2};
};

TEST_F(Learners, MakeTheTriangulationOfOneThreadOnAnyNumber) {
  const std::vector<LearntVertex> vertices = drawn_vertices(6000, 1);
  const std::vector<LearntVertex> first(vertices.begin(), vertices.begin() + 3000);
  Rank alone(problem_, grid_, 1);
  alone.learner.learn(first, kReceivedInsertion, nullptr);
  alone.learner.learn(changes_of(vertices), kReceivedInsertion, nullptr);
  std::string fault;
  EXPECT_TRUE(is_valid(alone.mesh(), &fault)) << fault;
  for (const int threads : {2, 3, 4}) {
    Rank rank(problem_, grid_, threads);
    rank.learner.learn(first, kReceivedInsertion, nullptr);
    std::vector<CellId> made;
    rank.learner.learn(changes_of(vertices), kReceivedInsertion, &made);
    EXPECT_EQ(cells_by_points(rank.mesh()), cells_by_points(alone.mesh())) << threads << " threads";
    EXPECT_TRUE(is_valid(rank.mesh(), &fault)) << fault;
    expect_lists_new_cells(rank.mesh(), {vertices.begin() + 3000, vertices.end()}, std::move(made));
  }
}

// Another worker holds all vertices, so that every change has to wait for the end of its round.
TEST_F(Learners, MakeChangesThatMeetALockInTheEnd) {
  const std::vector<LearntVertex> vertices = drawn_vertices(6000, 6);
  const std::vector<LearntVertex> first(vertices.begin(), vertices.begin() + 3000);
  Rank alone(problem_, grid_, 1), rank(problem_, grid_, 2);
  for (Rank* one : {&alone, &rank}) one->learner.learn(first, kReceivedInsertion, nullptr);
  VertexLocks other(77);
  for (VertexId v = 0; v < rank.mesh().vertex_bound(); ++v) other.try_lock(rank.mesh().vertex(v));
  const std::uint64_t before = rank.learner.num_put_off();
  std::vector<CellId> made;
  for (Rank* one : {&alone, &rank})
    one->learner.learn(changes_of(vertices), kReceivedInsertion, one == &rank ? &made : nullptr);
  other.unlock_all();
  EXPECT_GT(rank.learner.num_put_off(), before + 500);
  EXPECT_EQ(cells_by_points(rank.mesh()), cells_by_points(alone.mesh()));
  expect_lists_new_cells(rank.mesh(), {vertices.begin() + 3000, vertices.end()}, std::move(made));
}

TEST_F(Learners, LogWhatTheyLearnInAnOrderThatCanBeRepeated) {
  const std::vector<LearntVertex> vertices = drawn_vertices(6000, 2);
  const ScratchFolder folder;
  const std::string path = folder / "learner.log";
  {
    OperationLogWriter log(path);
    Rank rank(problem_, grid_, 4, &log);
    rank.learner.learn({vertices.begin(), vertices.begin() + 3000}, kReceivedInsertion, nullptr);
    rank.learner.learn(changes_of(vertices), kReceivedInsertion, nullptr);
    OperationLogHead head;
    head.box = {0, 0, 0, 1, 1, 1};
    log.finish(head);
    log.publish();
  }
  const OperationBatch all = read_operation_log(path).all;
  EXPECT_EQ(all.operations.size(), 6000u + 1500u);
  std::map<std::uint32_t, Point> present;  // by vertex number; a number is used again once it is free
  const std::uint32_t* removed = all.removed.data();
  for (const LoggedOperation& entry : all.operations) {
    const Point p{entry.point[0], entry.point[1], entry.point[2]};
    if (entry.kind == kReceivedRemoval) {
      ASSERT_EQ(present.at(*removed++), p);
      present.erase(entry.vertex);
    } else {
      ASSERT_TRUE(present.emplace(entry.vertex, p).second);
    }
  }
  EXPECT_EQ(present.size(), 4500u);
}

TEST_F(Learners, PassAFaultOfAThreadOn) {
  std::vector<LearntVertex> vertices = drawn_vertices(3000, 3);
  for (const int threads : {1, 4}) {
    Rank rank(problem_, grid_, threads);
    rank.learner.learn(vertices, kReceivedInsertion, nullptr);
    std::vector<LearntVertex> changes = drawn_vertices(3000, 4);
    changes[1234].kind = VertexKind::kUnused;  // no such vertex
    EXPECT_THROW(rank.learner.learn(changes, kReceivedInsertion, nullptr), InternalError);
    EXPECT_TRUE(is_valid(rank.mesh()));
    for (VertexId v = 0; v < rank.mesh().vertex_bound(); ++v) EXPECT_EQ(rank.mesh().vertex(v).lock, 0u);
  }
}

TEST_F(Learners, FindCellsByTheirVertices) {
  Rank rank(problem_, grid_, 1);
  rank.learner.learn(drawn_vertices(2000, 5), kReceivedInsertion, nullptr);
  const Mesh& mesh = rank.mesh();
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    std::array<Point, 4> vertices;
    for (std::size_t i = 0; i < 4; ++i) vertices[i] = mesh.point(mesh.cell(c).vertices[i]);
    EXPECT_EQ(rank.learner.find_cell(vertices), c);
    vertices[3] = vertices[3] + Vector{1e-6, 0, 0};
    EXPECT_EQ(rank.learner.find_cell(vertices), std::nullopt);
  }
}

// The centroids of the flat cells that the vertices of a grid make may round to points of other cells.
TEST_F(Learners, FindTheSameCellsOnAnyNumberOfThreadsFlatOnesIncluded) {
  std::vector<LearntVertex> vertices = drawn_vertices(1000, 7);
  const Vector step = 0.125 * (problem_.object.high - problem_.object.low);
  for (int i = 1; i < 8; ++i)
    for (int j = 1; j < 8; ++j)
      for (int k = 1; k < 8; ++k)
        vertices.push_back(
            {problem_.object.low + Vector{i * step.x, j * step.y, k * step.z}, VertexKind::kCircumcenter});
  for (const int threads : {1, 2, 5}) {
    Rank rank(problem_, grid_, threads);
    rank.learner.learn(vertices, kReceivedInsertion, nullptr);
    std::vector<CellId> cells;
    for (CellId c = 0; c < rank.mesh().cell_bound(); ++c)
      if (rank.mesh().cell(c).is_alive()) cells.push_back(c);
    std::vector<std::array<Point, 4>> searched(2 * cells.size());
    for (std::size_t n = 0; n < cells.size(); ++n) {
      for (std::size_t i = 0; i < 4; ++i)
        searched[2 * n][i] = rank.mesh().point(rank.mesh().cell(cells[n]).vertices[i]);
      searched[2 * n + 1] = searched[2 * n];
      searched[2 * n + 1][0] = searched[2 * n][0] + Vector{0, 1e-6, 0};
    }
    const auto found = rank.learner.find_cells(
        searched.size(), [&](std::size_t i) -> const std::array<Point, 4>& { return searched[i]; });
    ASSERT_EQ(found.size(), searched.size());
    for (std::size_t n = 0; n < cells.size(); ++n) {
      EXPECT_EQ(found[2 * n], cells[n]) << threads << " threads";
      EXPECT_EQ(found[2 * n + 1], std::nullopt) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace podm::test
