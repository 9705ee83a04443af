// Tests the selection of labels, their final indices, and the parsing of the options that select labels.
#include <gtest/gtest.h>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
using Merges = std::vector<LabelSelection::Merge>;

LabelSelection keep(const Ranges& ranges) { return {0, ranges, {}, {}}; }
LabelSelection drop(const Ranges& ranges) { return {0, {}, ranges, {}}; }
LabelSelection merge(const Merges& merges) { return {0, {}, {}, merges}; }
LabelSelection background(std::uint32_t value) { return {value, {}, {}, {}}; }

// An image with the values 0, 1, 2, 3, 9, 9, followed by zeros.
class Selection : public testing::Test {
 protected:
  Selection() {
    std::vector<std::uint8_t> voxels{0, 1, 2, 3, 9, 9};
    voxels.resize(24, 0);
    path_ = folder_.write("a.nii", nifti_file(nifti_header(), bytes_of_values(voxels)));
  }
  // The value of each of the first six voxels.
  std::vector<std::uint32_t> values(const LabelSelection& selection) const {
    const LabelImage image = read_image(path_, selection);
    for (std::size_t i = 2; i < image.labels.size(); ++i)
      EXPECT_LT(image.labels[i - 1].value, image.labels[i].value);
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < 6; ++i) result.push_back(image.labels.at(image.voxels[i]).value);
    return result;
  }
  std::string fault(const LabelSelection& selection) const {
    return fault_of<InputError>([&] { read_image(path_, selection); });
  }

  ScratchFolder folder_;
  std::string path_;
};

using Values = std::vector<std::uint32_t>;

TEST_F(Selection, AllByDefault) { EXPECT_EQ(values({}), (Values{0, 1, 2, 3, 9, 9})); }
TEST_F(Selection, Keep) { EXPECT_EQ(values(keep({{1, 1}, {3, 20}})), (Values{0, 1, 0, 3, 9, 9})); }
TEST_F(Selection, Drop) { EXPECT_EQ(values(drop({{2, 8}})), (Values{0, 1, 0, 0, 9, 9})); }
TEST_F(Selection, KeepAndDrop) { EXPECT_EQ(values({0, {{1, 3}}, {{2, 2}}, {}}), (Values{0, 1, 0, 3, 0, 0})); }

TEST_F(Selection, MergeTakesTheFirstValueAndTheName) {
  const LabelSelection selection = merge({{{9, 2}, "pair"}});
  EXPECT_EQ(values(selection), (Values{0, 1, 9, 3, 9, 9}));
  EXPECT_EQ(read_image(path_, selection).labels.back().name, "pair");
}

TEST_F(Selection, MergeKeepsWhatIsKeptOfItsValues) {
  EXPECT_EQ(values({0, {}, {{2, 2}}, {{{2, 3}, "pair"}}}), (Values{0, 1, 0, 2, 9, 9}));
}

TEST_F(Selection, AnotherBackground) {
  EXPECT_EQ(values(background(9)), (Values{0, 1, 2, 3, 9, 9}));
  const LabelImage image = read_image(path_, background(9));
  EXPECT_EQ(image.voxels[4], kBackground);
  EXPECT_NE(image.voxels[0], kBackground);
}

TEST_F(Selection, ALabelAskedForByItselfMustBeThere) {
  EXPECT_NE(fault(keep({{4, 4}})).find("label 4"), std::string::npos);
  EXPECT_NE(fault(drop({{4, 4}})).find("label 4"), std::string::npos);
  EXPECT_NE(fault(merge({{{1, 4}, "pair"}})).find("label 4"), std::string::npos);
}

TEST_F(Selection, ContradictionsAreRefused) {
  EXPECT_NE(fault(keep({{4, 8}})).find("foreground"), std::string::npos);
  EXPECT_NE(fault(drop({{0, 255}})).find("foreground"), std::string::npos);
  EXPECT_NE(fault(merge({{{1, 2}, "a"}, {{2, 3}, "b"}})).find("label 2"), std::string::npos);
  EXPECT_NE(fault(merge({{{1, 0}, "a"}})).find("background"), std::string::npos);
}

TEST(Phantom, IsSelectedFromLikeAFile) {
  const LabelImage all = read_image("phantom:spheres@32");
  ASSERT_GT(all.labels.size(), 2u);
  const std::uint32_t kept = all.labels[2].value;
  const LabelImage one = read_image("phantom:spheres@32", keep({{kept, kept}}));
  ASSERT_EQ(one.labels.size(), 2u);
  EXPECT_EQ(one.labels[1].value, kept);
  for (std::size_t i = 0; i < all.voxels.size(); ++i) ASSERT_EQ(all.voxels[i] == 2, one.voxels[i] == 1);
}

TEST(LabelRanges, Parse) {
  EXPECT_EQ(parse_label_ranges("1,3-7", "--labels"), (Ranges{{1, 1}, {3, 7}}));
  EXPECT_EQ(parse_label_ranges("4294967295", "--labels"), (Ranges{{4294967295u, 4294967295u}}));
}

TEST(LabelRanges, FaultsNameTheOption) {
  for (const char* text : {"", ",", "1,", "a", "1-", "-1", "7-3", "1-2-3", "4294967296", " 1", "+1", "1.5"}) {
    try {
      parse_label_ranges(text, "--drop");
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 8), "--drop: ") << error.what();
    }
  }
}

TEST(Merge, Parse) {
  const auto parsed = parse_merge("2,3=left kidney");
  EXPECT_EQ(parsed.values, (Values{2, 3}));
  EXPECT_EQ(parsed.name, "left kidney");
  for (const char* text : {"", "=", "2,3", "2,3=", "=kidney", "2,,3=kidney", "2-3=kidney", "x=kidney"})
    EXPECT_THROW(parse_merge(text), InputError) << text;
}

}  // namespace
}  // namespace podm
