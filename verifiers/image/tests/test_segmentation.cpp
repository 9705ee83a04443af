// Segmentations of 3D Slicer: layers are merged as the verifier documents (image/segmentation.h).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "errors.h"
#include "image/label_selection.h"
#include "image/size_image.h"
#include "made_files.h"

namespace podm::verify {
namespace {

constexpr std::size_t kVoxelsOfLayer = 24;

struct Part {  // a segment
  std::uint32_t value;
  std::size_t layer;
};
using Layers = std::vector<std::vector<std::uint8_t>>;

// Two segments in each of two layers; layers alternate in the order of segments.
const std::vector<Part> kParts{{1, 0}, {2, 1}, {3, 0}, {4, 1}};

Layers random_layers(const std::vector<Part>& parts, unsigned seed) {
  std::mt19937 random(seed);
  Layers layers(2);
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    for (std::size_t i = 0; i < kVoxelsOfLayer; ++i) {
      const Part& part = parts[random() % parts.size()];
      layers[layer].push_back(part.layer == layer ? static_cast<std::uint8_t>(part.value) : 0);
    }
  return layers;
}

std::string fields_of(const std::vector<Part>& parts) {
  std::string fields;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string segment = "Segment" + std::to_string(i);
    fields += segment + "_LabelValue:=" + std::to_string(parts[i].value) + "\n" + segment +
              "_Layer:=" + std::to_string(parts[i].layer) + "\n" + segment + "_Name:=part\n" + segment +
              "_Color:=0.5 1 0\n" + segment + "_Extent:=0 1 0 2 0 3\n";
  }
  return fields;
}

// A file of 2 x 3 x 4 voxels of two layers, which are axis `layer_axis` of the file.
std::string segmentation(const std::string& fields, const Layers& layers, bool is_gzipped = false,
                         std::size_t layer_axis = 0) {
  std::vector<std::size_t> sizes{2, 3, 4};
  std::vector<std::string> directions{"(1,0,0)", "(0,2,0)", "(0,0,3)"}, kinds{"domain", "space", "???"};
  const auto at = static_cast<std::ptrdiff_t>(layer_axis);
  sizes.insert(sizes.begin() + at, 2);
  directions.insert(directions.begin() + at, "none");
  kinds.insert(kinds.begin() + at, "list");
  std::string voxels;
  for (std::size_t i = 0; i < 2 * kVoxelsOfLayer; ++i) {
    std::vector<std::size_t> place;
    for (std::size_t axis = 0, rest = i; axis < 4; rest /= sizes[axis++]) place.push_back(rest % sizes[axis]);
    const std::size_t layer = place[layer_axis];
    place.erase(place.begin() + at);
    voxels += static_cast<char>(layers[layer][place[0] + 2 * (place[1] + 3 * place[2])]);
  }
  const std::string axes = fmt::format("sizes: {}\nspace directions: {}\nkinds: {}\n", fmt::join(sizes, " "),
                                       fmt::join(directions, " "), fmt::join(kinds, " "));
  return "NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\n" + axes +
         "space origin: (10,20,30)\nencoding: " + (is_gzipped ? "gzip" : "raw") + "\n" + fields + "\n" +
         (is_gzipped ? deflated(voxels) : voxels);
}

using IsAbove = std::function<bool(std::size_t, std::size_t)>;

void expect_merged(const Image& image, const std::vector<Part>& parts, const Layers& layers,
                   const IsAbove& is_above) {
  ASSERT_EQ(image.voxels.size(), kVoxelsOfLayer);
  for (std::size_t voxel = 0; voxel < kVoxelsOfLayer; ++voxel) {
    std::size_t top = parts.size();
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (layers[parts[i].layer][voxel] == parts[i].value && (top == parts.size() || is_above(i, top)))
        top = i;
    EXPECT_EQ(image.voxels[voxel], top == parts.size() ? 0 : parts[top].value) << voxel;
  }
}

void expect_refused(const std::string& bytes, const std::string& message,
                    const LabelSelection& selection = {}) {
  const Folder folder;
  const std::string path = folder.write("a.seg.nrrd", bytes);
  try {
    read_image(path, selection);
    ADD_FAILURE() << "no refusal with '" << message << "'";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path + ": ")) << text;
    EXPECT_NE(text.find(message), std::string::npos) << text;
  }
}

TEST(VerifierSegmentation, LaterSegmentsAreAboveEarlierOnes) {
  const Folder folder;
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const bool is_gzipped : {false, true})
      for (const std::size_t layer_axis : {0, 1, 2, 3}) {
        const Layers layers = random_layers(kParts, seed);
        const Image image = read_image(
            folder.write("a.seg.nrrd", segmentation(fields_of(kParts), layers, is_gzipped, layer_axis)));
        EXPECT_EQ(image.size, (std::array<int, 3>{2, 3, 4}));
        EXPECT_DOUBLE_EQ(image.voxel_to_ras[3], -10);
        expect_merged(image, kParts, layers, std::greater<>());
      }
}

TEST(VerifierSegmentation, TheOptionOrdersLayers) {
  const Folder folder;
  const Layers layers = random_layers(kParts, 3);
  const std::string path = folder.write("a.seg.nrrd", segmentation(fields_of(kParts), layers));
  const auto layer = [](std::size_t part) { return kParts[part].layer; };
  expect_merged(read_image(path, {.layers = {1, 0}}), kParts, layers,
                [&](auto a, auto b) { return layer(a) < layer(b); });
  expect_merged(read_image(path, {.layers = {0, 1}}), kParts, layers,
                [&](auto a, auto b) { return layer(a) > layer(b); });
  const Image one = read_image(path, {.layers = {1}});
  for (std::size_t i = 0; i < kVoxelsOfLayer; ++i) EXPECT_EQ(one.voxels[i], layers[1][i]);
}

TEST(VerifierSegmentation, SegmentsThatAreNotKeptAreBelowAllOthers) {
  const Folder folder;
  const Layers layers = random_layers(kParts, 4);
  const std::string path = folder.write("a.seg.nrrd", segmentation(fields_of(kParts), layers));
  expect_merged(read_image(path, {.drop = {{4, 4}}}), kParts, layers,
                [](auto a, auto b) { return b == 3 || (a != 3 && a > b); });
  expect_merged(read_image(path, {.keep = {{1, 1}}}), kParts, layers,
                [](auto a, auto b) { return a == 0 || (b != 0 && a > b); });
}

TEST(VerifierSegmentation, ACoveredLabelMayBeNamedInASelection) {
  const Folder folder;
  const std::vector<Part> parts{{1, 0}, {2, 1}};
  const Layers layers{std::vector<std::uint8_t>(kVoxelsOfLayer, 1),
                      std::vector<std::uint8_t>(kVoxelsOfLayer, 2)};
  const std::string path = folder.write("a.seg.nrrd", segmentation(fields_of(parts), layers));
  for (const LabelSelection& selection :
       {LabelSelection{.drop = {{1, 1}}}, LabelSelection{.drop = {{2, 2}}}}) {
    Image image = read_image(path, selection);
    select_labels(image, selection);
    EXPECT_EQ(image.voxels, std::vector<std::uint32_t>(kVoxelsOfLayer, 3 - selection.drop[0].first));
  }
}

TEST(VerifierSegmentation, SharedValuesAreNumberedInTheOrderOfSegments) {
  const Folder folder;
  const std::vector<Part> parts{{7, 1}, {7, 0}}, numbered{{1, 1}, {2, 0}};
  Layers layers = random_layers(parts, 5);
  const Image image = read_image(folder.write("a.seg.nrrd", segmentation(fields_of(parts), layers)));
  for (std::uint8_t& voxel : layers[1]) voxel = voxel == 7 ? 1 : 0;
  for (std::uint8_t& voxel : layers[0]) voxel = voxel == 7 ? 2 : 0;
  expect_merged(image, numbered, layers, std::greater<>());
}

TEST(VerifierSegmentation, FilesWithoutValuesHaveOneSegmentPerLayer) {
  const Folder folder;
  const std::vector<Part> parts{{1, 0}, {2, 1}};
  Layers layers(2, std::vector<std::uint8_t>(kVoxelsOfLayer));
  layers[0][0] = layers[0][1] = layers[1][1] = 1;
  const Image image =
      read_image(folder.write("a.seg.nrrd", segmentation("Segment0_Name:=a\nSegment1_Name:=b\n", layers)));
  layers[1][1] = 2;
  expect_merged(image, parts, layers, std::greater<>());
}

TEST(VerifierSegmentation, FaultsAreNamed) {
  const Layers layers = random_layers(kParts, 1);
  const std::string fields = fields_of(kParts);
  for (const auto& [from, to, message] : std::vector<std::array<const char*, 3>>{
           {"Segment1_LabelValue:=2\n", "", "Segment1 has no LabelValue"},
           {"Segment1_LabelValue:=2", "Segment1_LabelValue:=0", "Segment1_LabelValue is '0'"},
           {"Segment1_LabelValue:=2", "Segment1_LabelValue:=two", "Segment1_LabelValue is 'two'"},
           {"Segment3_LabelValue:=4", "Segment3_LabelValue:=2",
            "Segment3: another segment of layer 1 has its LabelValue 2"},
           {"Segment1_Layer:=1\n", "", "Segment1 has no Layer"},
           {"Segment1_Layer:=1", "Segment1_Layer:=2",
            "Segment1_Layer is '2', an integer from 0 to 1 is expected"},
           {"Segment2_Color:=0.5 1 0", "Segment2_Color:=0.5 2 0", "Segment2_Color"},
           {"Segment2_Extent:=0 1 0 2 0 3", "Segment2_Extent:=0 1 0 2 0", "Segment2_Extent"}})
    expect_refused(segmentation(replaced(fields, from, to), layers), message);
  expect_refused(segmentation("", layers), "one value per voxel is needed, this image has 2");
  expect_refused(segmentation(fields, layers), "--layers: no layer 2 among 2", {.layers = {0, 2}});
  expect_refused(kNrrdHeader + "encoding: raw\n\n" + kVoxels, "--layers: only a segmentation",
                 {.layers = {0}});
  Layers stray = layers;
  stray[1][2 * 3 + 2 + 1] = 9;
  expect_refused(segmentation(fields, stray), "voxel (1, 1, 1) of layer 1 is 9");
  const std::string whole = segmentation(fields, layers);
  expect_refused(whole.substr(0, whole.size() - 1), "truncated");
}

TEST(VerifierSegmentation, IsNoSizeImage) {
  const Folder folder;
  EXPECT_THROW(
      read_size_image(folder.write("a.seg.nrrd", segmentation(fields_of(kParts), random_layers(kParts, 1)))),
      InputError);
}

}  // namespace
}  // namespace podm::verify
