// Compares components with a flood fill, which starts at each voxel that no earlier fill has reached.
#include "image/components.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "tests/images.h"

namespace podm {
namespace {

std::optional<std::size_t> neighbour(const LabelImage& image, std::size_t at, unsigned side) {
  const std::size_t axis = side / 2;
  const std::array<std::size_t, 3> strides{1, image.index(0, 1, 0), image.index(0, 0, 1)};
  const auto size = static_cast<std::size_t>(image.size[axis]);
  const std::size_t position = at / strides[axis] % size;
  if (side % 2 == 0 ? position == 0 : position + 1 == size) return std::nullopt;
  return side % 2 == 0 ? at - strides[axis] : at + strides[axis];
}

constexpr unsigned kNone = ~0u;

// The component number of each voxel. Components are numbered by their first voxels.
std::vector<unsigned> flooded(const LabelImage& image) {
  std::vector<unsigned> number(image.voxels.size(), kNone);
  unsigned count = 0;
  for (std::size_t seed = 0; seed < number.size(); ++seed) {
    if (number[seed] != kNone) continue;
    std::vector<std::size_t> reached{seed};
    number[seed] = count;
    for (std::size_t next = 0; next < reached.size(); ++next)
      for (unsigned side = 0; side < 6; ++side)
        if (const auto other = neighbour(image, reached[next], side);
            other && number[*other] == kNone && image.voxels[*other] == image.voxels[seed]) {
          number[*other] = count;
          reached.push_back(*other);
        }
    ++count;
  }
  return number;
}

class ComponentsOfImages : public testing::TestWithParam<test::NamedImage> {};

TEST_P(ComponentsOfImages, AreThoseOfAFlood) {
  const LabelImage image = GetParam().make();
  const std::vector<unsigned> expected = flooded(image);
  const Components components(image);
  std::vector<std::uint64_t> voxels(components.size());
  for (int k = 0; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j)
      for (int i = 0; i < image.size[0]; ++i) {
        const Components::Id c = components.of({i, j, k});
        ASSERT_EQ(c, expected[image.index(i, j, k)]);
        ASSERT_EQ(components[c].label, image.voxels[image.index(i, j, k)]);
        if (voxels[c]++ == 0) {
          EXPECT_EQ(components[c].first, (Voxel{i, j, k}));
        }
      }
  for (Components::Id c = 0; c < components.size(); ++c) EXPECT_EQ(components[c].num_voxels, voxels[c]);
  EXPECT_EQ(components.size(), 1u + *std::max_element(expected.begin(), expected.end()));
}

TEST_P(ComponentsOfImages, AreInContactWhereVoxelsAre) {
  const LabelImage image = GetParam().make();
  const std::vector<unsigned> number = flooded(image);
  using Contact = std::tuple<unsigned, unsigned, unsigned>;
  std::map<Contact, int> expected, found;
  for (std::size_t at = 0; at < number.size(); ++at)
    for (unsigned side = 0; side < 6; ++side) {
      const auto other = neighbour(image, at, side);
      const unsigned b = other ? number[*other] : Components::kOutside;
      if (number[at] < b) ++expected[{number[at], b, side / 2}];
    }
  Components(image).for_each_contact([&](Components::Id a, Components::Id b, unsigned axis, int faces) {
    found[{std::min(a, b), std::max(a, b), axis}] += faces;
  });
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(All, ComponentsOfImages, testing::ValuesIn(test::images()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace podm
