// A cell's word holds its stamp, its mark, its reliance on others and the facets that pass R3. Each access
// changes its own bits only, and operations clear the bits of the facets whose other cell they replace.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "point_sets.h"
#include "triangulator.h"

namespace podm::test {
namespace {

constexpr std::array<VertexId, 4> kVertices{0, 1, 3, 7};  // of the box

// The content of the word of a cell.
struct Word {
  std::uint16_t stamp = 0;
  bool is_marked = false, relies_on_others = false;
  FacetMask passing = 0;

  friend bool operator==(const Word&, const Word&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Word& w) {
    return out << "stamp " << w.stamp << ", marked " << w.is_marked << ", relies " << w.relies_on_others
               << ", passing " << w.passing;
  }
};

Word word_of(const Mesh& mesh, CellId c) {
  return {mesh.stamp(c), mesh.is_marked(c), mesh.relies_on_others(c), mesh.facets_passing_r3(c)};
}
void put_in(Mesh& mesh, CellId c, const Word& word) {
  mesh.mark(c, word.is_marked);
  mesh.set_relies_on_others(c, word.relies_on_others);
  mesh.add_facets_passing_r3(c, word.passing);
}

// Calls visit(Word) for all values of the bits beside the stamp.
template <class Visit>
void for_each_word(const Visit& visit) {
  for (const bool is_marked : {false, true})
    for (const bool relies : {false, true})
      for (FacetMask passing = 0; passing <= kAllFacets; ++passing)
        visit(Word{.is_marked = is_marked, .relies_on_others = relies, .passing = passing});
}

TEST(WordOfCell, OfANewCellHasItsStampAlone) {
  Mesh mesh(kBox, 1 << 10);
  for_each_word([&](const Word& before) {
    put_in(mesh, 0, before);
    const std::uint16_t stamp = mesh.stamp(0);
    mesh.renew(0, kVertices);
    EXPECT_NE(mesh.stamp(0), stamp);
    EXPECT_EQ(word_of(mesh, 0), Word{.stamp = mesh.stamp(0)});
  });
}

TEST(WordOfCell, AddsFacetsToThoseThatPass) {
  Mesh mesh(kBox, 1 << 10);
  for_each_word([&](Word word) {
    for (FacetMask added = 0; added <= kAllFacets; ++added) {
      mesh.renew(0, kVertices);
      word.stamp = mesh.stamp(0);
      put_in(mesh, 0, word);
      mesh.add_facets_passing_r3(0, added);
      Word expected = word;
      expected.passing |= added;
      EXPECT_EQ(word_of(mesh, 0), expected) << word << ", added " << added;
    }
  });
}

TEST(WordOfCell, LosesTheFacetThatGetsAMirror) {
  Mesh mesh(kBox, 1 << 10);
  for (unsigned facet = 0; facet < 4; ++facet) {
    for_each_word([&](Word word) {
      mesh.renew(0, kVertices);
      word.stamp = mesh.stamp(0);
      put_in(mesh, 0, word);
      const std::array<FacetId, 4> mirrors = mesh.cell(0).mirrors;
      mesh.set_mirror(facet, 4 * 3 + facet);
      Word expected = word;
      expected.passing &= ~(1u << facet);
      EXPECT_EQ(word_of(mesh, 0), expected) << word << ", facet " << facet;
      for (unsigned k = 0; k < 4; ++k)
        EXPECT_EQ(mesh.cell(0).mirrors[k], k == facet ? 4 * 3 + facet : mirrors[k]);
    });
  }
}

// The stamp returns to its first value after many renewals, and neither changes other bits nor is changed.
TEST(WordOfCell, HasAStampThatWraps) {
  Mesh mesh(kBox, 1 << 10);
  const std::uint16_t first = mesh.stamp(0);
  int num_renewals = 0;
  do {
    const Word all{
        .stamp = mesh.stamp(0), .is_marked = true, .relies_on_others = true, .passing = kAllFacets};
    put_in(mesh, 0, all);
    ASSERT_EQ(word_of(mesh, 0), all) << num_renewals;
    mesh.renew(0, kVertices);
    ++num_renewals;
    ASSERT_EQ(word_of(mesh, 0), Word{.stamp = mesh.stamp(0)}) << num_renewals;
    ASSERT_LE(num_renewals, 1 << 16);
  } while (mesh.stamp(0) != first);
  EXPECT_GE(num_renewals, 1 << 10) << "a shorter cycle takes stale list entries for new cells";
}

TEST(WordOfCell, HoldsWhatWasPutInItLast) {
  Mesh mesh(kBox, 1 << 10);
  std::mt19937 random(31);
  std::vector<Word> expected;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) expected.push_back(word_of(mesh, c));
  for (int n = 0; n < 20'000; ++n) {
    const CellId c = random() % mesh.cell_bound();
    const FacetMask facets = random() % (kAllFacets + 1);
    const bool is_set = random() % 2 == 0;
    Word& word = expected[c];
    switch (random() % 5) {
      case 0:
        mesh.mark(c, word.is_marked = is_set);
        break;
      case 1:
        mesh.set_relies_on_others(c, word.relies_on_others = is_set);
        break;
      case 2:
        mesh.add_facets_passing_r3(c, facets), word.passing |= facets;
        break;
      case 3:
        mesh.set_mirror(4 * c + facets % 4, 4 * ((c + 1) % mesh.cell_bound()));
        word.passing &= ~(1u << facets % 4);
        break;
      case 4:
        if (random() % 8 != 0) break;  // otherwise few bits would ever be set
        mesh.renew(c, kVertices);
        EXPECT_NE(mesh.stamp(c), word.stamp);
        word = {.stamp = mesh.stamp(c)};
        break;
    }
    for (CellId d = 0; d < mesh.cell_bound(); ++d) ASSERT_EQ(word_of(mesh, d), expected[d]) << n;
  }
}

// A triangulation all of whose facets pass, and what an operation leaves of that.
class PassingFacets : public testing::Test {
 protected:
  PassingFacets() {
    for (const Point& p : random_points(3, 300, 9)) t_.insert(p);
    for (CellId c = 0; c < mesh().cell_bound(); ++c)
      if (mesh().cell(c).is_alive()) mesh().add_facets_passing_r3(c, kAllFacets);
  }
  Mesh& mesh() { return t_.mesh; }
  bool is_new(CellId c) const {
    const std::vector<CellId>& created = t_.operation.created();
    return std::find(created.begin(), created.end(), c) != created.end();
  }
  // No facet of a new cell passes, from either side. All other facets still do.
  void expect_none_at_new_cells() {
    ASSERT_FALSE(t_.operation.created().empty());
    for (CellId c = 0; c < mesh().cell_bound(); ++c) {
      const Cell& cell = mesh().cell(c);
      if (!cell.is_alive()) continue;
      for (unsigned k = 0; k < 4; ++k) {
        const FacetId mirror = cell.mirrors[k];
        const bool passes = !is_new(c) && (mirror == kNoFacet || !is_new(cell_of(mirror)));
        ASSERT_EQ(mesh().facets_passing_r3(c) >> k & 1, passes ? 1u : 0u) << c << ", facet " << k;
      }
    }
  }
  VertexId free_vertex(unsigned seed) {
    std::mt19937 random(seed);
    for (;;) {
      const VertexId v = random() % mesh().vertex_bound();
      if (mesh().vertex(v).kind == VertexKind::kCircumcenter) return v;
    }
  }

  Triangulator t_{kBox};
};

TEST_F(PassingFacets, AreThoseWhoseCellsAnInsertionLeaves) {
  ASSERT_TRUE(t_.insert({0.1, -0.2, 0.3}));
  expect_none_at_new_cells();
}

TEST_F(PassingFacets, AreThoseWhoseCellsAnInsertionWithRemovalsLeaves) {
  const Point p{0.1, -0.2, 0.3};
  t_.operation.plan_insertion(p, t_.conflicting_cell(p));
  t_.operation.for_each_region_vertex([&](VertexId v, CellId seed) {
    if (mesh().vertex(v).kind == VertexKind::kCircumcenter && t_.operation.num_planned_removals() < 3 &&
        !t_.operation.removes(v))
      t_.operation.plan_removal(v, seed);
  });
  ASSERT_EQ(t_.operation.num_planned_removals(), 3u);
  ASSERT_EQ(t_.operation.commit_insertion(p, VertexKind::kIsosurface, 0), StepResult::kDone);
  expect_none_at_new_cells();
}

TEST_F(PassingFacets, AreThoseWhoseCellsARemovalLeaves) {
  const VertexId v = free_vertex(1);
  ASSERT_EQ(t_.operation.plan_removal(v, t_.cell_around(v)), StepResult::kDone);
  ASSERT_EQ(t_.operation.commit_removals(), StepResult::kDone);
  expect_none_at_new_cells();
}

TEST_F(PassingFacets, AreThoseWhoseCellsAMoveLeaves) {
  const VertexId v = free_vertex(2);
  ASSERT_EQ(t_.operation.plan_move(v, t_.cell_around(v)), StepResult::kDone);
  ASSERT_EQ(t_.operation.plan_move_to(mesh().point(v) + Vector{0.01, 0.02, -0.01}), StepResult::kDone);
  t_.operation.move().glue_star();
  t_.operation.commit_move();
  expect_none_at_new_cells();
}

TEST_F(PassingFacets, AreTheSameAfterAPlanThatWasGivenUp) {
  const Point p{0.1, -0.2, 0.3};
  t_.operation.plan_insertion(p, t_.conflicting_cell(p));
  t_.operation.rollback();
  for (CellId c = 0; c < mesh().cell_bound(); ++c)
    if (mesh().cell(c).is_alive()) {
      ASSERT_EQ(word_of(mesh(), c), (Word{.stamp = mesh().stamp(c), .passing = kAllFacets})) << c;
    }
}

}  // namespace
}  // namespace podm::test
