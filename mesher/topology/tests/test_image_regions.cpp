// Regions of images against a second count: every voxel, face, edge and corner is one item, items of a region
// are joined where one is in the boundary of the other, and the Euler characteristic is that of the chains of
// such items. Shapes have known numbers.
#include "topology/image_regions.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "tests/images.h"
#include "topology/disjoint_sets.h"

namespace podm {
namespace {

using LabelAt = ImageRegions::LabelAt;

// Items of the grid: those with three odd indices are voxels, with two faces, with one edges, with none
// corners. An item is in the boundary of another one if their indices differ by at most 1 and the other's odd
// ones include its own.
class Items {
 public:
  Items(const LabelImage& image, LabelIndex label, const LabelAt& label_at)
      : size_{2 * image.size[0] + 5, 2 * image.size[1] + 5, 2 * image.size[2] + 5}, is_in_(count()) {
    const auto voxel = [&](int i, int j, int k) {
      const bool is_inside =
          i >= 0 && j >= 0 && k >= 0 && i < image.size[0] && j < image.size[1] && k < image.size[2];
      return is_inside && image.voxels[image.index(i, j, k)] == label;
    };
    for_each([&](int x, int y, int z) {
      int has = 0, all = 0;
      std::vector<Voxel> those;
      const auto ends = [&](int u) {
        return u % 2 != 0 ? std::vector{(u - 1) / 2} : std::vector{u / 2 - 1, u / 2};
      };
      for (const int k : ends(z))
        for (const int j : ends(y))
          for (const int i : ends(x)) {
            ++all;
            if (!voxel(i - kMargin, j - kMargin, k - kMargin)) continue;
            ++has;
            those.push_back({i, j, k});
          }
      bool is_in = has == all;
      const int dimension = x % 2 + y % 2 + z % 2;
      const bool is_pair = has == 2 && std::abs(those[0].i - those[1].i) + std::abs(those[0].j - those[1].j) +
                                               std::abs(those[0].k - those[1].k) ==
                                           2;
      const Point place{(x - 1) / 2.0 - kMargin, (y - 1) / 2.0 - kMargin, (z - 1) / 2.0 - kMargin};
      if (dimension == 1 && is_pair) is_in = label_at(place) == label;
      if (dimension == 0 && has > 0 && has < all) is_in = label_at(place) == label;
      is_in_[number(x, y, z)] = is_in;
    });
  }

  /// Components, handles and cavities of all.
  std::array<std::int64_t, 3> numbers() const {
    DisjointSets joined(count());
    std::int64_t euler = 0;
    for_each([&](int x, int y, int z) { euler += chains_from(x, y, z, joined); });
    std::array<std::set<std::uint32_t>, 2> roots;  // of the rest, and of the items
    for (std::uint32_t item = 0; item < count(); ++item) roots[is_in_[item]].insert(joined.root(item));
    const auto components = static_cast<std::int64_t>(roots[1].size()),
               cavities = static_cast<std::int64_t>(roots[0].size()) - 1;
    return {components, components + cavities - euler, cavities};
  }

 private:
  static constexpr int kMargin = 1;  // voxels of background around the image
  std::size_t count() const { return static_cast<std::size_t>(size_[0] * size_[1] * size_[2]); }
  std::uint32_t number(int x, int y, int z) const {
    return static_cast<std::uint32_t>((z * size_[1] + y) * size_[0] + x);
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int z = 0; z < size_[2]; ++z)
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x) visit(x, y, z);
  }
  // Calls visit(x, y, z) for the items of whose boundary this one is a part.
  template <class Visit>
  void for_each_above(int x, int y, int z, const Visit& visit) const {
    const auto range = [](int u, int size) {
      std::vector<int> values{u};
      if (u % 2 == 0 && u > 0) values.push_back(u - 1);
      if (u % 2 == 0 && u + 1 < size) values.push_back(u + 1);
      return values;
    };
    for (const int w : range(z, size_[2]))
      for (const int v : range(y, size_[1]))
        for (const int u : range(x, size_[0]))
          if (u != x || v != y || w != z) visit(u, v, w);
  }
  // Joins the item with those above it, and returns the sum over the chains that begin with it.
  std::int64_t chains_from(int x, int y, int z, DisjointSets& joined) const {
    for_each_above(x, y, z, [&](int u, int v, int w) {
      if (is_in_[number(u, v, w)] == is_in_[number(x, y, z)]) joined.join(number(x, y, z), number(u, v, w));
    });
    return is_in_[number(x, y, z)] ? alternating(x, y, z) : 0;
  }
  // The sum over all chains of items that begin with this one, with sign.
  std::int64_t alternating(int x, int y, int z) const {
    std::int64_t sum = 1;
    for_each_above(x, y, z, [&](int u, int v, int w) {
      if (is_in_[number(u, v, w)]) sum -= alternating(u, v, w);
    });
    return sum;
  }

  std::array<int, 3> size_;
  std::vector<bool> is_in_;
};

std::array<std::int64_t, 3> sums_of(const ImageRegions& regions, LabelIndex label) {
  std::array<std::int64_t, 3> sums{};
  for (std::uint32_t r = 0; r < regions.size(); ++r)
    if (regions[r].label == label) {
      ++sums[0];
      sums[1] += regions[r].handles;
      sums[2] += regions[r].cavities;
    }
  return sums;
}

LabelImage noise(unsigned seed, int num_labels, int share_of_ten) {
  std::mt19937 random(seed);
  return test::make_image({5, 4, 6}, {1, 1, 1}, num_labels, [&](int, int, int) {
    const bool is_background = static_cast<int>(random() % 10) >= share_of_ten;
    return is_background ? 0 : 1 + static_cast<int>(random() % static_cast<unsigned>(num_labels));
  });
}

// A label for every place, the same each time.
LabelIndex any_label(const Point& at, int num_labels, unsigned seed) {
  const auto whole = [](double x) { return static_cast<std::uint32_t>(static_cast<int>(2 * x) + 16); };
  std::minstd_rand random(seed * 1000003u + whole(at.x) * 8191u + whole(at.y) * 131071u +
                          whole(at.z) * 524287u);
  random.discard(5);
  return static_cast<LabelIndex>(random() % static_cast<unsigned>(num_labels + 1));
}

TEST(ImageRegions, NumbersAreThoseOfASecondCount) {
  for (unsigned seed = 0; seed < 120; ++seed) {
    const int num_labels = 1 + static_cast<int>(seed % 3);
    const LabelImage image = noise(seed, num_labels, 3 + static_cast<int>(seed % 7));
    const LabelAt none = [](const Point&) { return LabelIndex{1000}; };
    const LabelAt any = [&](const Point& at) { return any_label(at, num_labels, seed); };
    for (const LabelAt& label_at : {none, any}) {
      const ImageRegions regions(image, label_at);
      for (LabelIndex label = 1; label <= num_labels; ++label) {
        const LabelAt read = [&](const Point& at) { return label_at(at); };
        EXPECT_EQ(sums_of(regions, label), Items(image, label, read).numbers())
            << "seed " << seed << " label " << label;
      }
    }
    for (LabelIndex label = 1; label <= num_labels; ++label) {
      const LabelAt all = [&](const Point&) { return label; };
      EXPECT_EQ(sums_of(ImageRegions(image, all), label), Items(image, label, all).numbers())
          << "seed " << seed << " label " << label;
    }
  }
}

struct Shape {
  const char* name;
  std::function<bool(int, int, int)> is_in;
  std::array<std::int64_t, 3> numbers;
};

TEST(ImageRegions, ShapesHaveKnownNumbers) {
  const auto cube = [](int i, int j, int k, int r) {
    return std::max({std::abs(i), std::abs(j), std::abs(k)}) <= r;
  };
  const std::vector<Shape> shapes{
      {"cube", [&](int i, int j, int k) { return cube(i, j, k, 4); }, {1, 0, 0}},
      {"shell", [&](int i, int j, int k) { return cube(i, j, k, 4) && !cube(i, j, k, 3); }, {1, 0, 1}},
      {"two_shells",
       [&](int i, int j, int k) {
         const int r = std::max({std::abs(i), std::abs(j), std::abs(k)});
         return r == 2 || r == 4;
       },
       {2, 0, 2}},
      {"plate_with_three_holes",
       [&](int i, int j, int k) {
         return k == 0 && std::abs(j) <= 4 && !(j == 0 && (i == -2 || i == 0 || i == 2));
       },
       {1, 3, 0}},
      {"frame",
       [](int i, int j, int k) {
         const int far = (std::abs(i) == 4) + (std::abs(j) == 4) + (std::abs(k) == 4);
         return far >= 2 && std::abs(i) <= 4 && std::abs(j) <= 4 && std::abs(k) <= 4;
       },
       {1, 5, 0}},
  };
  for (const Shape& shape : shapes) {
    const LabelImage image = test::make_image({11, 11, 11}, {1, 1, 1}, 1, [&](int i, int j, int k) {
      return shape.is_in(i - 5, j - 5, k - 5) ? 1 : 0;
    });
    const ImageRegions regions(image, [](const Point&) { return kBackground; });
    EXPECT_EQ(sums_of(regions, 1), shape.numbers) << shape.name;
    EXPECT_EQ(regions.ambiguous_places().size(), 0u) << shape.name;
  }
}

TEST(ImageRegions, CubesThatMeetAtAnEdgeOrACornerFollowTheirCaller) {
  for (const int far : {0, 1}) {
    const LabelImage image = test::make_image({4, 4, 4}, {1, 1, 1}, 1, [&](int i, int j, int k) {
      return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 1 + far);
    });
    for (const bool is_joined : {false, true}) {
      const ImageRegions regions(image, [&](const Point&) { return static_cast<LabelIndex>(is_joined); });
      ASSERT_EQ(regions.size(), is_joined ? 1u : 2u);
      EXPECT_EQ(regions.ambiguous_places().size(), 1u);
      for (std::uint32_t r = 0; r < regions.size(); ++r) {
        EXPECT_EQ(regions[r].ambiguous, 1u);
        EXPECT_EQ(regions[r].group, regions[0].group);
        EXPECT_EQ(regions[r].num_joined, is_joined ? 2u : 1u);
        EXPECT_EQ(regions[r].handles, 0);
        EXPECT_EQ(regions[r].cavities, 0);
      }
      EXPECT_EQ(regions.of({1, 1, 1}), 0u);
      EXPECT_EQ(regions.of({0, 0, 0}), ImageRegions::kNone);
    }
  }
}

}  // namespace
}  // namespace podm
