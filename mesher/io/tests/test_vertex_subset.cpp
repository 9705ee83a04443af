#include "io/vertex_subset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace podm {
namespace {

// Assigns subsets of few and many facets one after the other.
TEST(VertexSubset, HasTheVerticesOfTheFacetsInTheOrderOfTheMesh) {
  constexpr std::uint32_t kVertices = 1000;
  std::mt19937_64 random(1);
  VertexSubset subset(kVertices);
  for (const std::size_t num_facets : {1u, 2000u, 5u, 0u, 20u, 21u, 400u, 1u}) {
    std::vector<std::array<std::uint32_t, 3>> facets(num_facets);
    std::set<std::uint32_t> expected;
    for (auto& facet : facets) {
      for (std::uint32_t& v : facet) expected.insert(v = static_cast<std::uint32_t>(random() % kVertices));
    }
    subset.assign(facets);
    ASSERT_TRUE(
        std::equal(subset.vertices().begin(), subset.vertices().end(), expected.begin(), expected.end()));
    for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(subset.position(subset.vertices()[i]), i);
  }
}

}  // namespace
}  // namespace podm
