// An operation in a zone reads beyond the zone and changes nothing there. The lock contract detects an
// operation that does. Only builds with PODM_CHECK_LOCKS have the lock contract.
#include <gtest/gtest.h>

#include <map>

#include "delaunay/lock_contract.h"
#include "delaunay/planted_fault.h"
#include "delaunay/tests/point_sets.h"
#include "delaunay/tests/triangulator.h"
#include "delaunay/tests/validity.h"
#include "distributed/zone.h"

namespace podm::test {
namespace {

// The cubes are smaller than cells, so that no cell is so deep in the zone that its radius alone decides.
template <class Inner>
class ZoneContract : public testing::Test {
 protected:
  ZoneContract() {
    for (const Point& p : random_points(5, 300, 9)) triangulator_.insert(p);
    operation_.locks().confine(zone_);
  }
  void TearDown() override { plant_fault({}); }

  // Inserts a point into every cell of the old mesh that is still alive. Returns the number of insertions by
  // result.
  std::map<StepResult, int> refine_with(LocksTaken locks) {
    plant_fault(locks);
    std::map<StepResult, int> results;
    const CellId bound = mesh_.cell_bound();
    for (CellId c = 0; c < bound; ++c)
      if (mesh_.cell(c).is_alive()) ++results[insert_into(c)];
    return results;
  }

  Triangulator triangulator_{kBox};
  Mesh& mesh_ = triangulator_.mesh;
  CubeGrid grid_{kBox, 2};
  Zone zone_{left_half(grid_), left_half(grid_).grown(10), 1};
  Operation<ZoneLocks<Inner>> operation_{mesh_, triangulator_.pool, 1};

 private:
  static CubeSet left_half(const CubeGrid& grid) {
    CubeSet cubes(grid);
    for (CubeId cube = 0; cube < grid.num_cubes(); ++cube)
      if (2 * grid.place_of(cube)[0] < grid.size()[0]) cubes.insert(cube);
    return cubes;
  }

  StepResult insert_into(CellId c) {
    const AttemptScope scope(operation_.locks());
    StepResult result = operation_.reserve(c, mesh_.stamp(c));
    if (result != StepResult::kDone) return result;
    const Point p = centroid(c);
    result = operation_.plan_insertion(p, c);
    if (result == StepResult::kDone) result = operation_.commit_insertion(p, VertexKind::kCircumcenter, 0);
    if (result != StepResult::kDone) operation_.rollback();
    operation_.release();
    return result;
  }

  Point centroid(CellId c) const {
    Point sum{0, 0, 0};
    for (const VertexId v : mesh_.cell(c).vertices) sum = sum + mesh_.point(v);
    return {sum.x / 4, sum.y / 4, sum.z / 4};
  }
};

template <class Inner>
using ZoneContractDeathTest = ZoneContract<Inner>;
using InnerLocks = testing::Types<NoLocks, VertexLocks>;
TYPED_TEST_SUITE(ZoneContractDeathTest, InnerLocks);

TYPED_TEST(ZoneContractDeathTest, KeepsOperationsThatReachTheEndOfTheZone) {
  const auto results = this->refine_with({});
  EXPECT_GT(results.at(StepResult::kDone), 0);
  EXPECT_GT(results.at(StepResult::kOutOfReach), 0);
  EXPECT_TRUE(is_valid(this->mesh_));
}

TYPED_TEST(ZoneContractDeathTest, NoticesAReplacedCellWithAVertexBeyond) {
  EXPECT_DEATH(this->refine_with({.in_zone = 3}), "is replaced with 3 of its vertices held");
}

TYPED_TEST(ZoneContractDeathTest, LetsReadBeyondTheZoneAndChangeNothing) {
  const auto is_beyond = [&](VertexId v) { return !this->zone_.has(this->mesh_.point(v)); };
  CellId c = 0;
  while (!this->mesh_.peek_is_alive(c) || !std::ranges::all_of(this->mesh_.peek_vertices(c), is_beyond)) ++c;
  auto& locks = this->operation_.locks();
  for (const VertexId v : this->mesh_.peek_vertices(c)) locks.try_lock(this->mesh_.vertex(v));
  const AttemptScope scope(locks);
  const auto mirrors = this->mesh_.cell(c).mirrors;
  EXPECT_DEATH(this->mesh_.set_mirrors(c, mirrors), "is given a mirror with 0 of its vertices held");
  EXPECT_DEATH(this->mesh_.mark(c, true), "is replaced with 0 of its vertices held");
  locks.unlock_all();
}

}  // namespace
}  // namespace podm::test
