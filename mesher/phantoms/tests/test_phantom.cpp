#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/fault_of.h"

namespace podm {
namespace {

std::map<std::string, double> volumes_mm3(const LabelImage& image) {
  const double voxel = image.spacing[0] * image.spacing[1] * image.spacing[2];
  std::map<std::string, double> volumes;
  for (const Label& label : image.labels) volumes[label.name] = 0;
  for (const LabelIndex index : image.voxels) volumes[image.labels[index].name] += voxel;
  return volumes;
}

std::string refusal(const std::string& name, int size) {
  return fault_of<InputError>([&] { make_phantom(name, size); });
}

// The label index at a point of the world, mm.
LabelIndex label_at(const LabelImage& image, double x, double y, double z) {
  const auto& a = image.voxel_to_ras;
  return image.voxels[image.index(static_cast<int>(std::lround((x - a[3]) / a[0])),
                                  static_cast<int>(std::lround((y - a[7]) / a[5])),
                                  static_cast<int>(std::lround((z - a[11]) / a[10])))];
}

// The pairs of labels of voxels that share a face.
std::set<std::pair<std::string, std::string>> neighbours(const LabelImage& image) {
  std::set<std::pair<LabelIndex, LabelIndex>> pairs;
  const auto [nx, ny, nz] = image.size;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const LabelIndex here = image.voxels[image.index(i, j, k)];
        if (i > 0) pairs.insert(std::minmax(here, image.voxels[image.index(i - 1, j, k)]));
        if (j > 0) pairs.insert(std::minmax(here, image.voxels[image.index(i, j - 1, k)]));
        if (k > 0) pairs.insert(std::minmax(here, image.voxels[image.index(i, j, k - 1)]));
      }
    }
  }
  std::set<std::pair<std::string, std::string>> named;
  for (const auto& [a, b] : pairs) named.insert(std::minmax(image.labels[a].name, image.labels[b].name));
  return named;
}

class EveryPhantom : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Phantoms, EveryPhantom, testing::ValuesIn(phantom_names()),
                         [](const auto& name) { return name.param; });

TEST_P(EveryPhantom, LongestAxisHasTheSizeAskedFor) {
  for (const int size : {16, 17, 50, 64, 99, 128}) {
    const LabelImage image = make_phantom(GetParam(), size);
    EXPECT_EQ(*std::max_element(image.size.begin(), image.size.end()), size);
    EXPECT_EQ(image.voxels.size(), image.num_voxels());
  }
}

TEST_P(EveryPhantom, LabelsHaveDistinctNamesAndAscendingValues) {
  const LabelImage image = make_phantom(GetParam(), 32);
  EXPECT_EQ(image.labels[0].value, 0u);
  std::set<std::string> names;
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    EXPECT_GT(image.labels[i].value, image.labels[i - 1].value);
    EXPECT_FALSE(image.labels[i].name.empty());
    EXPECT_TRUE(names.insert(image.labels[i].name).second) << image.labels[i].name;
  }
}

TEST_P(EveryPhantom, EveryLabelIsPresent) {
  for (const int size : {64, 65, 71, 80, 97, 128, 160}) {
    if (GetParam() == "membrane" && size < 160) continue;  // larger voxels may miss it
    for (const auto& [name, volume] : volumes_mm3(make_phantom(GetParam(), size))) {
      EXPECT_TRUE(volume > 0 || name.empty()) << name << " at " << size;
    }
  }
}

TEST_P(EveryPhantom, TwoVoxelsOfBackgroundSurroundAllButTheCrystal) {
  if (GetParam() == "crystal") return;
  for (const int size : {16, 37, 64, 128}) {
    const LabelImage image = make_phantom(GetParam(), size);
    for (int k = 0; k < image.size[2]; ++k) {
      for (int j = 0; j < image.size[1]; ++j) {
        for (int i = 0; i < image.size[0]; ++i) {
          const auto is_near_end = [](int at, int length) { return at < 2 || at >= length - 2; };
          if (is_near_end(i, image.size[0]) || is_near_end(j, image.size[1]) ||
              is_near_end(k, image.size[2])) {
            ASSERT_EQ(image.voxels[image.index(i, j, k)], kBackground) << i << " " << j << " " << k;
          }
        }
      }
    }
  }
}

TEST_P(EveryPhantom, VolumesDoNotDependOnTheResolution) {
  const auto coarse = volumes_mm3(make_phantom(GetParam(), 64));
  const auto fine = volumes_mm3(make_phantom(GetParam(), 128));
  double body = 0;
  for (const auto& [name, volume] : fine) body += name.empty() ? 0 : volume;
  for (const auto& [name, volume] : fine) {
    if (name.empty() || volume < 0.01 * body) continue;
    EXPECT_NEAR(coarse.at(name), volume, 0.1 * volume) << name;
  }
}

TEST_P(EveryPhantom, TwoRunsMakeTheSameImage) {
  EXPECT_EQ(make_phantom(GetParam(), 64).voxels, make_phantom(GetParam(), 64).voxels);
}

TEST_P(EveryPhantom, AffineIsAxisAlignedAndCentredAtTheOrigin) {
  const LabelImage image = make_phantom(GetParam(), 40);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      EXPECT_EQ(image.voxel_to_ras[4 * row + column], row == column ? image.spacing[row] : 0);
    }
    const double last = image.voxel_to_ras[4 * row + 3] + (image.size[row] - 1) * image.spacing[row];
    EXPECT_NEAR(image.voxel_to_ras[4 * row + 3], -last, 1e-9);
  }
}

TEST_P(EveryPhantom, OtherSizesAreRefused) {
  for (const int size : {-1, 0, 15, 1025, 1 << 30}) {
    const std::string message = refusal(GetParam(), size);
    EXPECT_NE(message.find(GetParam()), std::string::npos) << message;
    EXPECT_NE(message.find("16"), std::string::npos) << message;
    EXPECT_NE(message.find("1024"), std::string::npos) << message;
  }
}

TEST(Phantom, AnUnknownNameIsRefusedWithTheKnownOnes) {
  for (const std::string name : {"", "sphere", "Abdomen"}) {
    const std::string message = refusal(name, 64);
    for (const std::string& known : phantom_names()) {
      EXPECT_NE(message.find(known), std::string::npos) << message;
    }
  }
}

TEST(Abdomen, IsAsLargeAsAnAbdomen) {
  const LabelImage image = make_phantom("abdomen", 64);
  EXPECT_GE(image.labels.size(), 13u);
  const std::array<double, 3> expected_mm{350, 250, 200};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(image.size[axis] * image.spacing[axis], expected_mm[axis], 0.15 * expected_mm[axis]);
  }
}

TEST(Abdomen, OrgansLieOnTheirSides) {
  const LabelImage image = make_phantom("abdomen", 128);
  const auto name_at = [&](double x, double y, double z) {
    return image.labels[label_at(image, x, y, z)].name;
  };
  EXPECT_EQ(name_at(110, 10, 20), "liver");  // x is right, y anterior
  EXPECT_EQ(name_at(-120, -20, 35), "spleen");
  EXPECT_EQ(name_at(0, -48, 0), "vertebra");
  EXPECT_EQ(name_at(0, -75, 0), "spinal canal");
}

TEST(Abdomen, OnlySkinTouchesTheOutside) {
  for (const auto& [a, b] : neighbours(make_phantom("abdomen", 256))) {
    if (a.empty() && !b.empty()) {
      EXPECT_EQ(b, "skin");
    }
  }
}

TEST(Abdomen, WallsEncloseWhatTheyHold) {
  const std::map<std::string, std::set<std::string>> wall_of{
      {"stomach fluid", {"stomach wall", "stomach gas"}},
      {"stomach gas", {"stomach wall", "stomach fluid"}},
      {"small bowel lumen", {"small bowel wall"}},
      {"colon content", {"colon wall"}},
      {"skin", {"", "subcutaneous fat"}}};
  for (const auto& [a, b] : neighbours(make_phantom("abdomen", 256))) {
    if (a == b) continue;
    for (const auto& [inner, outer] : {std::pair{a, b}, std::pair{b, a}}) {
      const auto wall = wall_of.find(inner);
      if (wall == wall_of.end()) continue;
      EXPECT_TRUE(wall->second.contains(outer)) << inner << " touches " << outer;
    }
  }
}

// The number of voxels of a label along a line of voxels, on both sides of a shell.
int voxels_through(const LabelImage& image, const std::string& name, std::array<int, 3> at,
                   std::size_t axis) {
  int count = 0;
  for (at[axis] = 0; at[axis] < image.size[axis]; ++at[axis])
    count += image.labels[image.voxels[image.index(at[0], at[1], at[2])]].name == name;
  return count;
}

TEST(Bubbles, AllMeetOnTheAxisAndAreCongruent) {
  const LabelImage image = make_phantom("bubbles", 129);
  const auto volumes = volumes_mm3(image);
  EXPECT_NEAR(volumes.at("bubble 2"), volumes.at("bubble 1"), 0.02 * volumes.at("bubble 1"));
  EXPECT_NEAR(volumes.at("bubble 3"), volumes.at("bubble 1"), 0.02 * volumes.at("bubble 1"));
  const auto name_at = [&](double x, double y) { return image.labels[label_at(image, x, y, 0)].name; };
  EXPECT_EQ(name_at(3, 0), "bubble 1");
  EXPECT_EQ(name_at(-3, 3), "bubble 2");
  EXPECT_EQ(name_at(-3, -3), "bubble 3");
}

TEST(Crystal, GrainsFillTheImage) {
  for (const auto& [name, volume] : volumes_mm3(make_phantom("crystal", 64)))
    EXPECT_EQ(name.empty(), volume == 0) << name;
}

TEST(Head, TissuesTouchOnlyTheirNeighbours) {
  const std::map<std::string, std::set<std::string>> touches{{"", {"scalp"}},
                                                             {"scalp", {"", "skull"}},
                                                             {"skull", {"scalp", "csf"}},
                                                             {"csf", {"skull", "grey matter"}},
                                                             {"grey matter", {"csf", "white matter"}},
                                                             {"white matter", {"grey matter", "ventricles"}},
                                                             {"ventricles", {"white matter"}}};
  for (const auto& [a, b] : neighbours(make_phantom("head", 192))) {
    if (a == b) continue;
    EXPECT_TRUE(touches.at(a).contains(b)) << a << " touches " << b;
  }
}

TEST(Membrane, IsOneVoxelThick) {
  const LabelImage image = make_phantom("membrane", 160);
  std::array<int, 3> middle{image.size[0] / 2, 0, image.size[2] / 2};
  EXPECT_EQ(voxels_through(image, "membrane", middle, 1), 1);
  middle[0] -= 10;
  EXPECT_EQ(voxels_through(image, "membrane", middle, 1), 1);
}

TEST(Shells, AreOneTwoAndThreeVoxelsThick) {
  const LabelImage image = make_phantom("shells", 64);
  const std::array<int, 3> middle{0, image.size[1] / 2, image.size[2] / 2};
  EXPECT_EQ(voxels_through(image, "thin shell", middle, 0), 2);
  EXPECT_EQ(voxels_through(image, "middle shell", middle, 0), 4);
  EXPECT_EQ(voxels_through(image, "thick shell", middle, 0), 6);
}

TEST(Spheres, VolumesAreThoseOfBalls) {
  const auto ball = [](double radius) { return 4.0 / 3 * M_PI * radius * radius * radius; };
  const auto volumes = volumes_mm3(make_phantom("spheres", 128));
  EXPECT_NEAR(volumes.at("core"), ball(35), 0.01 * ball(35));
  EXPECT_NEAR(volumes.at("shell"), ball(60) - ball(35), 0.01 * ball(60));
  EXPECT_LT(volumes.at("neighbour"), ball(36));
  EXPECT_TRUE(neighbours(make_phantom("spheres", 64)).contains({"neighbour", "shell"}));
}

TEST(Torus, VolumesAreThoseOfATorusAndABall) {
  const auto volumes = volumes_mm3(make_phantom("torus", 128));
  const double ring = 2 * M_PI * M_PI * 60 * 22 * 22, ball = 4.0 / 3 * M_PI * 30 * 30 * 30;
  EXPECT_NEAR(volumes.at("ring"), ring, 0.01 * ring);
  EXPECT_NEAR(volumes.at("ball"), ball, 0.01 * ball);
}

}  // namespace
}  // namespace podm
