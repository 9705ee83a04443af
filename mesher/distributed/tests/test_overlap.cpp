// Ranks find every difference between their copies of a cube, and a run with a lost vertex makes no mesh.
#include "distributed/overlap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "delaunay/tests/triangulator.h"
#include "distributed/in_process_ranks.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/messages.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm::test {
namespace {

const Box kObject{{0, 0, 0}, {4, 1, 1}};

struct Given {
  Point point;
  VertexKind kind;
};
const std::vector<Given> kVertices{{{0.3, 0.2, 0.6}, VertexKind::kCircumcenter},
                                   {{1.4, 0.7, 0.1}, VertexKind::kIsosurface},
                                   {{1.6, 0.3, 0.8}, VertexKind::kCircumcenter},
                                   {{2.5, 0.4, 0.5}, VertexKind::kIsosurface},
                                   {{3.2, 0.6, 0.3}, VertexKind::kCircumcenter}};

// Rank 0 wrote the four cubes. Returns its fault, or what follows from it, if rank 1 has these vertices and
// believes that it knows some of the cubes.
std::string fault_if_other_has(const std::vector<Given>& vertices, const std::vector<CubeId>& known) {
  return fault_of<InternalError>([&] {
    run_ranks({.num_ranks = 2}, [&](Communication& ranks) {
      const CubeGrid grid(kObject, 1);
      Triangulator store({{-9, -9, -9}, {9, 9, 9}});
      for (const Given& one : ranks.rank() == 0 ? kVertices : vertices) store.insert(one.point, one.kind);
      CubeSet cubes(grid);
      for (const CubeId cube : ranks.rank() == 0 ? std::vector<CubeId>{0, 1, 2, 3} : known)
        cubes.insert(cube);
      check_overlap(
          store.mesh, cubes, [](CubeId) { return 0; }, 2, ranks);
    });
  });
}

TEST(Overlap, MayHaveTheSameVerticesInAnyOrder) {
  EXPECT_EQ(fault_if_other_has(kVertices, {0, 1, 2, 3}), "no error");
  EXPECT_EQ(fault_if_other_has({kVertices.rbegin(), kVertices.rend()}, {0, 1, 2, 3}), "no error");
}

TEST(Overlap, MayNotLackAVertexNorHaveOneMoreNorAnotherOne) {
  const std::vector<std::function<void(std::vector<Given>&)>> changes{
      [](auto& v) { v.erase(v.begin() + 1); },
      [](auto& v) {
        v.push_back({{1.5, 0.5, 0.5}, VertexKind::kCircumcenter});
      },
      [](auto& v) { v[1].point.x = std::nextafter(v[1].point.x, 2.0); },
      [](auto& v) { std::swap(v[1].kind, v[2].kind); }};
  for (const auto& change : changes) {
    std::vector<Given> vertices = kVertices;
    change(vertices);
    const std::string fault = fault_if_other_has(vertices, {0, 1, 2, 3});
    EXPECT_NE(fault.find("rank 1 of the cube of side 1 mm at (1 0 0) mm"), std::string::npos) << fault;
    EXPECT_NE(fault.find("rank 0, which wrote the cube, has 2"), std::string::npos) << fault;
    EXPECT_EQ(fault_if_other_has(vertices, {0, 2, 3}), "no error") << "the cube is not known";
  }
}

// Forwards all calls, and drops one vertex of the n-th message that brings vertices.
class LosesAVertex : public Communication {
 public:
  LosesAVertex(Communication& ranks, int nth) : ranks_(ranks), left_(nth) {}
  int rank() const override { return ranks_.rank(); }
  int size() const override { return ranks_.size(); }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override {
    std::vector<Bytes> received = ranks_.all_to_all(std::move(messages));
    for (Bytes& message : received)
      if (brings_vertices(message) && --left_ == 0) drop_last(message);
    return received;
  }
  std::vector<Bytes> all_gather(Bytes message) override { return ranks_.all_gather(std::move(message)); }
  void sum(std::span<std::uint64_t> values) override { ranks_.sum(values); }
  void maximum(std::span<std::uint64_t> values) override { ranks_.maximum(values); }
  void barrier() override { ranks_.barrier(); }
  void announce(std::uint64_t value) override { ranks_.announce(value); }
  std::uint64_t announced() override { return ranks_.announced(); }
  double seconds() const override { return ranks_.seconds(); }
  bool is_virtual() const override { return ranks_.is_virtual(); }
  RankReport report() const override { return ranks_.report(); }
  void charge(double seconds) override { ranks_.charge(seconds); }
  bool has_lost() const { return left_ <= 0; }

 private:
  static constexpr std::size_t kCount = sizeof(std::uint64_t), kVertex = sizeof(Point) + 8;
  static std::uint64_t number_at(const Bytes& message, std::size_t at) {
    std::uint64_t number = 0;
    std::memcpy(&number, message.data() + at, kCount);
    return number;
  }
  static std::size_t end_of_cubes(const Bytes& message) {
    return kCount + sizeof(CubeId) * number_at(message, 0);
  }
  // Such a message holds cubes and then vertices, each after their number.
  static bool brings_vertices(const Bytes& message) {
    if (message.size() < kCount || number_at(message, 0) > message.size()) return false;
    const std::size_t vertices = end_of_cubes(message);
    return vertices + kCount < message.size() &&
           vertices + kCount + kVertex * number_at(message, vertices) == message.size();
  }
  static void drop_last(Bytes& message) {
    const std::size_t at = end_of_cubes(message);
    const std::uint64_t number = number_at(message, at) - 1;
    std::memcpy(message.data() + at, &number, kCount);
    message.resize(message.size() - kVertex);
  }

  Communication& ranks_;
  int left_;
};

TEST(Overlap, OfARunThatLosesAVertexOnItsWayEndsTheRun) {
  const LabelImage image = ball(24, 9);
  MeshingOptions options;
  options.sizes.radius_mm = 1.5;
  options.team.threads = 1;
  for (const int nth : {1, 2, 4}) {
    bool has_lost = false;
    const std::string fault = fault_of<InternalError>([&] {
      run_ranks({.num_ranks = 3, .one_at_a_time = true}, [&](Communication& ranks) {
        LosesAVertex network(ranks, ranks.rank() == 1 ? nth : 1 << 30);
        try {
          mesh_image_on_ranks(image, options, network);
        } catch (...) {
          if (ranks.rank() == 1) has_lost = network.has_lost();
          throw;
        }
      });
    });
    EXPECT_TRUE(has_lost);
    EXPECT_NE(fault.find("the copy of rank 1 of the cube"), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace podm::test
