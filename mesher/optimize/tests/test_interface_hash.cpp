// The hash depends only on the facets between labels.
#include "optimize/interface_hash.h"

#include <gtest/gtest.h>

#include "optimize/tests/optimized_mesh.h"

namespace podm::test {
namespace {

class InterfaceHash : public testing::TestWithParam<NamedImage> {
 protected:
  std::uint64_t hash() {
    std::uint64_t sum = 0;
    mesh_.for_each_cell([&](CellId c) { sum += share_of_interface_hash(mesh(), c, mesh().label(c)); });
    return sum;
  }
  Mesh& mesh() { return mesh_.mesh(); }
  MeshToOptimize mesh_{GetParam().make(), 1.8, 1.1};
};

TEST_P(InterfaceHash, IsThatOfOtherCellsBetweenTheSameFacets) {
  const std::uint64_t before = hash();
  const auto facets = mesh_.interface_facets();
  const auto content = mesh_.content();
  StopControl stop({}, {}, [](std::uint64_t) {});
  mesh_.optimize(Executor::kThreads, 1, 1, stop);
  EXPECT_EQ(hash() == before, mesh_.interface_facets() == facets);
  EXPECT_NE(mesh_.content(), content);
}

TEST_P(InterfaceHash, IsAnotherOneWhereACellChangesItsLabel) {
  const std::uint64_t before = hash();
  const auto other = static_cast<LabelIndex>(mesh_.parameters().sizes.num_labels());
  std::vector<CellId> cells;
  mesh_.for_each_cell([&](CellId c) { cells.push_back(c); });
  for (std::size_t i = 0; i < cells.size(); i += 1 + cells.size() / 200) {
    for (const LabelIndex label : {kBackground, other}) {
      const LabelIndex own = std::exchange(mesh().label(cells[i]), label);
      EXPECT_NE(hash(), before);
      mesh().label(cells[i]) = own;
    }
  }
  EXPECT_EQ(hash(), before);
}

INSTANTIATE_TEST_SUITE_P(Images, InterfaceHash, testing::Values(images()[0], images()[2], images()[3]),
                         [](const auto& image) { return std::string(image.param.name); });

}  // namespace
}  // namespace podm::test
