// Segmentations of 3D Slicer: names, colours, and layers that are merged.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "image/tests/segmentation_file.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Bytes = SegmentationFile<std::uint8_t>;

class Segmentation : public testing::Test {
 protected:
  template <class Voxel>
  LabelImage read(const SegmentationFile<Voxel>& file, const LabelSelection& selection = {}) const {
    return read_image(folder_.write("a.seg.nrrd", file.bytes()), selection);
  }
  void expect_refused(const std::string& bytes, const std::string& message,
                      const LabelSelection& selection = {}) const {
    const std::string path = folder_.write("a.seg.nrrd", bytes);
    try {
      read_image(path, selection);
      ADD_FAILURE() << "no refusal with '" << message << "'";
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with(path + ": ")) << text;
      EXPECT_NE(text.find(message), std::string::npos) << text;
    }
  }

  ScratchFolder folder_;
};

std::uint32_t value_at(const LabelImage& image, std::size_t voxel) {
  return image.labels[image.voxels[voxel]].value;
}

const Label& label_of(const LabelImage& image, std::uint32_t value) {
  const auto found = std::find_if(image.labels.begin(), image.labels.end(),
                                  [&](const Label& label) { return label.value == value; });
  EXPECT_NE(found, image.labels.end()) << value;
  return *found;
}

// Two bones in layer 0, the skin in layer 1, a vessel in layer 0 that comes last.
template <class Voxel = std::uint8_t>
SegmentationFile<Voxel> arm(unsigned seed = 1) {
  SegmentationFile<Voxel> file{.segments = {{"ulna", 1, 0, "1 0 0"},
                                            {"radius", 2, 0, "0 0.5 1"},
                                            {"skin", 3, 1, "0.2 0.4 0.6"},
                                            {"vessel", 4, 0, "0 0 0"}},
                               .layers = {}};
  file.draw_voxels(2, seed);
  return file;
}

// Returns the label of the segment that `is_above` puts on top, 0 if no segment covers the voxel.
template <class Voxel, class IsAbove>
std::uint32_t merged(const SegmentationFile<Voxel>& file, std::size_t voxel, IsAbove is_above) {
  std::optional<std::size_t> top;
  for (std::size_t i = 0; i < file.segments.size(); ++i)
    if (file.covers(file.segments[i], voxel) && (!top || is_above(i, *top))) top = i;
  return top ? file.segments[*top].value : 0;
}

bool is_later(std::size_t i, std::size_t j) { return i > j; }

TEST_F(Segmentation, OneLayerHasNamesAndColours) {
  Bytes file = arm();
  file.segments[2].layer = 0;
  for (const bool is_gzipped : {false, true}) {
    file.is_gzipped = is_gzipped;
    file.draw_voxels(1, 7);
    const LabelImage image = read(file);
    for (std::size_t i = 0; i < file.num_voxels(); ++i) EXPECT_EQ(value_at(image, i), file.layers[0][i]);
    for (const SegmentInFile& segment : file.segments)
      EXPECT_EQ(label_of(image, segment.value).name, segment.name);
    EXPECT_EQ(label_of(image, 1).colour, (Rgb{255, 0, 0}));
    EXPECT_EQ(label_of(image, 2).colour, (Rgb{0, 128, 255}));
    EXPECT_EQ(label_of(image, 3).colour, (Rgb{51, 102, 153}));
    EXPECT_FALSE(image.labels[0].colour);
    EXPECT_TRUE(image.warnings.empty());
  }
}

template <class Voxel>
void expect_merged_by_hand(const SegmentationFile<Voxel>& file, const LabelImage& image) {
  for (std::size_t i = 0; i < file.num_voxels(); ++i)
    ASSERT_EQ(value_at(image, i), merged(file, i, is_later)) << "voxel " << i;
}

TEST_F(Segmentation, LaterSegmentsAreAboveEarlierOnes) {
  for (unsigned seed = 0; seed < 10; ++seed)
    for (const bool is_gzipped : {false, true})
      for (const std::size_t layer_axis : {0, 1, 2, 3}) {
        Bytes file = arm(seed);
        file.is_gzipped = is_gzipped;
        file.layer_axis = layer_axis;
        expect_merged_by_hand(file, read(file));
      }
}

template <class Voxel>
SegmentationFile<Voxel> arm_of(const char* type) {
  SegmentationFile<Voxel> file = arm<Voxel>();
  file.type = type;
  return file;
}

TEST_F(Segmentation, VoxelsMayHaveAnyType) {
  expect_merged_by_hand(arm_of<std::int16_t>("short"), read(arm_of<std::int16_t>("short")));
  expect_merged_by_hand(arm_of<std::uint32_t>("uint"), read(arm_of<std::uint32_t>("uint")));
  expect_merged_by_hand(arm_of<std::int64_t>("int64"), read(arm_of<std::int64_t>("int64")));
  expect_merged_by_hand(arm_of<std::uint64_t>("uint64"), read(arm_of<std::uint64_t>("uint64")));
  expect_merged_by_hand(arm_of<float>("float"), read(arm_of<float>("float")));
}

TEST_F(Segmentation, TheLargestLabelValue) {
  auto file = arm_of<std::uint32_t>("uint");
  file.segments[2].value = 0xffffffffU;
  file.draw_voxels(2, 3);
  expect_merged_by_hand(file, read(file));
}

TEST_F(Segmentation, ObliqueDirectionsAreThoseOfAPlainImage) {
  const std::string directions = "(0.6,0.8,0) (-1.6,1.2,0) (0,0,-3)";
  Bytes file = arm();
  file.directions = directions;
  const LabelImage image = read(file);
  const std::array<double, 12> expected{-0.6, 1.6, 0, -10, -0.8, -1.2, 0, -20, 0, 0, -3, 30};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(image.voxel_to_ras[i], expected[i], 1e-12);
  EXPECT_EQ(image.size, file.size);
  expect_merged_by_hand(file, image);
}

TEST_F(Segmentation, LayersHaveTheOrderOfTheOption) {
  const Bytes file = arm();
  const auto layer_of = [&](std::size_t segment) { return file.segments[segment].layer; };
  const LabelImage bones_on_top = read(file, {.layers = {1, 0}}),
                   skin_on_top = read(file, {.layers = {0, 1}}), bones = read(file, {.layers = {0}}),
                   skin = read(file, {.layers = {1}});
  for (std::size_t i = 0; i < file.num_voxels(); ++i) {
    EXPECT_EQ(value_at(bones_on_top, i),
              merged(file, i, [&](auto a, auto b) { return layer_of(a) < layer_of(b); }));
    EXPECT_EQ(value_at(skin_on_top, i),
              merged(file, i, [&](auto a, auto b) { return layer_of(a) > layer_of(b); }));
    EXPECT_EQ(value_at(bones, i), file.layers[0][i]);
    EXPECT_EQ(value_at(skin, i), file.layers[1][i]);
  }
}

TEST_F(Segmentation, SegmentsThatAreNotKeptCoverNothing) {
  const Bytes file = arm();
  const LabelImage dropped = read(file, {.drop = {{4, 4}}}), kept = read(file, {.keep = {{1, 2}}});
  for (std::size_t i = 0; i < file.num_voxels(); ++i) {
    Bytes without = file;
    without.segments.pop_back();
    EXPECT_EQ(value_at(dropped, i), merged(without, i, is_later));
    without.segments.pop_back();
    EXPECT_EQ(value_at(kept, i), merged(without, i, is_later));
  }
}

TEST_F(Segmentation, LabelsAreNumberedIfLayersShareValues) {
  Bytes file = arm();
  file.segments[2].value = 1;
  file.draw_voxels(2, 5);
  const LabelImage image = read(file);
  for (std::size_t i = 0; i < file.segments.size(); ++i) {
    EXPECT_EQ(image.segments[i].label.value, i + 1);
    EXPECT_EQ(image.segments[i].stored_value, file.segments[i].value);
    EXPECT_EQ(label_of(image, static_cast<std::uint32_t>(i + 1)).name, file.segments[i].name);
  }
  Bytes renamed = file;  // by hand: the same file with distinct values
  for (std::size_t i = 0; i < file.segments.size(); ++i)
    renamed.segments[i].value = static_cast<std::uint32_t>(i + 1);
  for (std::uint8_t& voxel : renamed.layers[1]) voxel = voxel == 1 ? 3 : voxel;
  expect_merged_by_hand(renamed, image);
  EXPECT_TRUE(std::any_of(image.warnings.begin(), image.warnings.end(), [](const std::string& warning) {
    return warning.find("share label values") != std::string::npos &&
           warning.find("1 ulna, 2 radius, 3 skin, 4 vessel") != std::string::npos;
  }));
}

TEST_F(Segmentation, CoveredVoxelsAreCountedAndReported) {
  const Bytes file = arm();
  const LabelImage image = read(file);
  for (std::size_t s = 0; s < file.segments.size(); ++s) {
    std::uint64_t voxels = 0, covered = 0;
    for (std::size_t i = 0; i < file.num_voxels(); ++i) {
      voxels += file.covers(file.segments[s], i);
      covered += file.covers(file.segments[s], i) && merged(file, i, is_later) != file.segments[s].value;
    }
    EXPECT_EQ(image.segments[s].voxels, voxels);
    EXPECT_EQ(image.segments[s].covered, covered);
    const bool is_reported =
        std::any_of(image.warnings.begin(), image.warnings.end(), [&](const std::string& warning) {
          return warning.find("'" + file.segments[s].name + "'") != std::string::npos;
        });
    EXPECT_EQ(is_reported, covered > 0) << file.segments[s].name;
  }
}

TEST_F(Segmentation, ASegmentThatIsEntirelyCoveredCanStillBeNamed) {
  Bytes file = arm();
  std::fill(file.layers[1].begin(), file.layers[1].end(), std::uint8_t{3});
  for (std::uint8_t& voxel : file.layers[0]) voxel = voxel == 4 ? 0 : voxel;
  file.segments.pop_back();
  const LabelImage all = read(file);
  EXPECT_EQ(all.labels.size(), 2u);
  EXPECT_NE(all.warnings.at(0).find("all "), std::string::npos) << all.warnings[0];
  EXPECT_EQ(read(file, {.drop = {{1, 1}}}).labels.size(), 2u);
  EXPECT_EQ(read(file, {.keep = {{1, 1}}}).labels.at(1).name, "ulna");
}

TEST_F(Segmentation, ATableReplacesNamesAndColours) {
  const LabelImage image =
      read(arm(), {.table = {{1, "Ulna", Rgb{1, 2, 3}}, {2, "Radius"}, {0, "air"}, {9, "nowhere"}}});
  EXPECT_EQ(label_of(image, 1).name, "Ulna");
  EXPECT_EQ(label_of(image, 1).colour, (Rgb{1, 2, 3}));
  EXPECT_EQ(label_of(image, 2).name, "Radius");
  EXPECT_EQ(label_of(image, 2).colour, (Rgb{0, 128, 255}));
  EXPECT_EQ(label_of(image, 3).name, "skin");
  EXPECT_EQ(image.labels[0].name, "air");
}

TEST_F(Segmentation, AMergedLabelHasTheColourOfItsFirst) {
  const LabelImage image = read(arm(), {.merges = {{{2, 1}, "bones"}}});
  EXPECT_EQ(label_of(image, 2).name, "bones");
  EXPECT_EQ(label_of(image, 2).colour, (Rgb{0, 128, 255}));
}

// Before version 5, 3D Slicer wrote each segment as a layer of its own, without values.
TEST_F(Segmentation, OldFilesHaveOneSegmentPerLayer) {
  Bytes file = arm();
  file.segments.clear();
  file.layers.assign(2, std::vector<std::uint8_t>(file.num_voxels()));
  file.layers[0][0] = file.layers[0][1] = file.layers[1][1] = 1;
  file.more_fields = "Segment0_Name:=bone\nSegment1_Name:=skin\nSegment1_Color:=1 1 1\n";
  const LabelImage image = read(file);
  EXPECT_EQ(value_at(image, 0), 1u);
  EXPECT_EQ(value_at(image, 1), 2u);
  EXPECT_EQ(value_at(image, 2), 0u);
  EXPECT_EQ(label_of(image, 1).name, "bone");
  EXPECT_EQ(label_of(image, 2).colour, (Rgb{255, 255, 255}));
}

struct BadHeader {
  const char* from;
  const char* to;
  const char* message;
};

TEST_F(Segmentation, FaultsOfTheHeaderNameTheirField) {
  const std::vector<BadHeader> kCases{
      {"Segment1_LabelValue:=2\n", "", "Segment1 has no label value (Segment1_LabelValue)"},
      {"Segment1_LabelValue:=2\n", "Segment1_LabelValue:=\n", "Segment1_LabelValue"},
      {"Segment1_LabelValue:=2\n", "Segment1_LabelValue:=0\n", "Segment1_LabelValue '0' is not a label"},
      {"Segment1_LabelValue:=2\n", "Segment1_LabelValue:=-2\n", "Segment1_LabelValue '-2' is not a label"},
      {"Segment1_LabelValue:=2\n", "Segment1_LabelValue:=4294967296\n", "is not a label"},
      {"Segment1_LabelValue:=2\n", "Segment1_LabelValue:=1\n",
       "segment 'ulna of the patient's left arm' and segment 'radius of the patient's left arm' have the "
       "same "
       "label value 1 in layer 0"},
      {"Segment2_Layer:=1\n", "", "Segment2 has no layer (Segment2_Layer)"},
      {"Segment2_Layer:=1\n", "Segment2_Layer:=2\n",
       "Segment2_Layer '2' is not a layer of the file, which has 2"},
      {"Segment2_Layer:=1\n", "Segment2_Layer:=one\n", "Segment2_Layer 'one' is not a layer"},
      {"Segment0_Color:=1 0 0\n", "Segment0_Color:=1 0\n",
       "Segment0_Color '1 0' is not three numbers from 0 to 1"},
      {"Segment0_Color:=1 0 0\n", "Segment0_Color:=1 0 red\n", "Segment0_Color"},
      {"Segment0_Color:=1 0 0\n", "Segment0_Color:=1 0 1.5\n", "Segment0_Color"},
      {"Segment0_Color:=1 0 0\n", "Segment0_Color:=1 0 nan\n", "Segment0_Color"},
      {"Segment0_Extent:=0 4 0 3 0 2\n", "Segment0_Extent:=0 4 0 3 0\n",
       "Segment0_Extent '0 4 0 3 0' is not six integers"},
      {"Segment0_Extent:=0 4 0 3 0 2\n", "Segment0_Extent:=0 4 0 3 0 two\n", "Segment0_Extent"}};
  Bytes file = arm();
  for (SegmentInFile& segment : file.segments) segment.name += " of the patient's left arm";
  const std::string bytes = file.bytes();
  for (const BadHeader& bad : kCases) {
    std::string changed = bytes;
    const std::size_t at = changed.find(bad.from);
    ASSERT_NE(at, std::string::npos) << bad.from;
    expect_refused(changed.replace(at, std::string(bad.from).size(), bad.to), bad.message);
  }
}

TEST_F(Segmentation, VoxelsOfNoSegmentAreNamed) {
  Bytes file = arm();
  file.layers[1][5 * 4 + 5 + 2] = 9;
  expect_refused(file.bytes(),
                 "voxel (2, 1, 1) of layer 1 is 9, the label value of no segment in this layer");
}

TEST_F(Segmentation, LayersThatAreMissingAreNamed) {
  expect_refused(arm().bytes(), "--layers: layer 2 is not in the image, whose layers are 0 to 1",
                 {.layers = {0, 2}});
  expect_refused(nrrd_header(kNrrdFields + "encoding: raw\n") + kVoxels, "--layers: the image has no layers",
                 {.layers = {0}});
  EXPECT_THROW(read_image("phantom:spheres@8", {.layers = {0}}), InputError);
}

TEST_F(Segmentation, SeveralValuesPerVoxelWithoutSegmentsAreRefused) {
  Bytes file = arm();
  file.segments.clear();
  expect_refused(file.bytes(), "one value per voxel is needed, this image has 2");
}

TEST_F(Segmentation, IsNoSizeImage) {
  const std::string path = folder_.write("a.seg.nrrd", arm().bytes());
  EXPECT_THROW(read_size_image(path), InputError);
}

TEST_F(Segmentation, MissingVoxelsAreTruncation) {
  for (const bool is_gzipped : {false, true}) {
    Bytes file = arm();
    file.is_gzipped = is_gzipped;
    std::string bytes = file.bytes();
    expect_refused(bytes.substr(0, bytes.size() - 2), "truncated");
  }
}

TEST_F(Segmentation, LayersCountForTheMemoryLimit) {
  const std::string path = folder_.write("a.seg.nrrd", arm().bytes());
  EXPECT_NO_THROW(read_image(path, {}, 1, 60 * (2 + 4)));
  EXPECT_THROW(read_image(path, {}, 1, 60 * (2 + 4) - 1), InputError);
}

TEST(Layers, AreParsedOrRefused) {
  EXPECT_EQ(parse_layers("1,0", "--layers"), (LayerOrder{1, 0}));
  for (const char* text : {"", "1,", "a", "-1", "0,1,0", "1-2"})
    EXPECT_THROW(parse_layers(text, "--layers"), InputError) << text;
}

}  // namespace
}  // namespace podm
