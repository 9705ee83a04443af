#include <gtest/gtest.h>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

class LabelTable : public testing::Test {
 protected:
  std::vector<Label> read(const std::string& text) const {
    return read_label_table(folder_.write("labels.txt", text));
  }
  void expect_refused(const std::string& text, const std::string& place, const std::string& fault) const {
    try {
      read(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("labels.txt" + place + ": "), std::string::npos) << message;
      EXPECT_NE(message.find(fault), std::string::npos) << message;
    }
  }

  ScratchFolder folder_;
};

void expect_label(const Label& label, std::uint32_t value, const std::string& name,
                  const std::optional<Rgb>& colour) {
  EXPECT_EQ(label.value, value);
  EXPECT_EQ(label.name, name);
  EXPECT_EQ(label.colour, colour);
}

TEST_F(LabelTable, ItkSnap) {
  for (const char* title : {"", "# ITK-SnAP Label Description File\r\n"}) {
    const auto labels = read(std::string(title) +
                             "# IDX -R- -G- -B- -A-- VIS MSH LABEL\r\n"
                             "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
                             "\n"
                             "   17   255    1    2     0.35  1  1    \"left kidney #2\"\r\n");
    ASSERT_EQ(labels.size(), 2u);
    expect_label(labels[0], 0, "Clear Label", Rgb{0, 0, 0});
    expect_label(labels[1], 17, "left kidney #2", Rgb{255, 1, 2});
  }
}

TEST_F(LabelTable, FreeSurfer) {
  for (const char* title : {"", "#$Id: FreeSurferColorLUT.txt $\n#No. Label Name:        R   G   B   A\n"}) {
    const auto labels = read(std::string(title) +
                             "0   Unknown                     0   0   0   0\n\n"
                             "17  Left-Hippocampus          220 216  20   0\n"
                             "11101  ctx lh G_and_S  23 220  60   0\n");
    ASSERT_EQ(labels.size(), 3u);
    expect_label(labels[0], 0, "Unknown", Rgb{0, 0, 0});
    expect_label(labels[1], 17, "Left-Hippocampus", Rgb{220, 216, 20});
    expect_label(labels[2], 11101, "ctx lh G_and_S", Rgb{23, 220, 60});
  }
}

TEST_F(LabelTable, Slicer) {
  const auto labels = read(
      "# Color table file /tmp/GenericAnatomyColors.ctbl\n# 2 values\n0 background 0 0 0 0\n"
      "2 soft_tissue 177 122 101 255\n");
  ASSERT_EQ(labels.size(), 2u);
  expect_label(labels[1], 2, "soft_tissue", Rgb{177, 122, 101});
}

TEST_F(LabelTable, ValueAndNameLines) {
  const auto labels = read("1 Precentral_L 2001\n2\tPrecentral_R\n3 \"left lobe\"\n");
  ASSERT_EQ(labels.size(), 3u);
  expect_label(labels[0], 1, "Precentral_L", std::nullopt);
  expect_label(labels[1], 2, "Precentral_R", std::nullopt);
  expect_label(labels[2], 3, "left lobe", std::nullopt);
}

TEST_F(LabelTable, BlanksBelongToANameAndNumbersAtItsEndDoNot) {
  const auto labels = read(
      "1 Left lung\n2  Lobe of  the lung 2001 7\n3 4\n4 nan inf\n5 liver 0.5 -1\n"
      "6 Segment 4 of liver\n");
  ASSERT_EQ(labels.size(), 6u);
  expect_label(labels[0], 1, "Left lung", std::nullopt);
  expect_label(labels[1], 2, "Lobe of the lung", std::nullopt);
  expect_label(labels[2], 3, "4", std::nullopt);
  expect_label(labels[3], 4, "nan inf", std::nullopt);
  expect_label(labels[4], 5, "liver", std::nullopt);
  expect_label(labels[5], 6, "Segment 4 of liver", std::nullopt);
}

TEST_F(LabelTable, AByteOrderMarkIsSkipped) {
  const auto labels = read(
      "\xef\xbb\xbf"
      "1 liver\r\n2 spleen\r\n");
  ASSERT_EQ(labels.size(), 2u);
  expect_label(labels[0], 1, "liver", std::nullopt);
}

TEST_F(LabelTable, FaultsNameTheLine) {
  for (const char* line : {"Precentral_L 1", "-1 name", "4294967296 name", "1", "2x name", "1 \"\""})
    expect_refused(std::string("7 fine\n") + line + "\n", ":2", "");
  for (const char* line :
       {"8 name 1 2 3", "8 name 1 2 256 0", "8 name 1 2 -3 0", "8 1 2 3 0", "8 name", "8 \"name\" 1 2 3 0"})
    expect_refused(std::string("7 fine 1 2 3 4\n") + line + "\n", ":2", "NAME R G B A");
  for (const char* line : {"8 1 2 3 1 1 1", "8 1 2 3 1 1 \"name\"", "8 1 2 300 1 1 1 \"name\"",
                           "8 1 2 3 one 1 1 \"name\"", "8 name 1 2 3 4"})
    expect_refused(std::string("7 1 2 3 1 1 1 \"fine\"\n") + line + "\n", ":2", "VIS MSH");
}

TEST_F(LabelTable, ATitleDecidesTheFormat) {
  expect_refused("# ITK-SnAP Label Description File\n1 name\n", ":2", "a line of ITK-SNAP");
  expect_refused("#No. Label Name: R G B A\n\n1 name\n", ":3", "NAME R G B A");
  expect_refused("# Color table file x.ctbl\n1 name\n", ":2", "NAME R G B A");
}

TEST_F(LabelTable, AnUnknownFormatIsRefused) {
  for (const char* text : {"LabelValue,Name,Color_R\n1,liver,3\n", "\x89PNG\r\n", "{\"1\": \"liver\"}"})
    expect_refused(text, ":1", "no known format of label tables (known: ITK-SNAP");
}

TEST_F(LabelTable, AFileWithoutNamesIsRefused) {
  EXPECT_THROW(read("# nothing\n"), InputError);
  EXPECT_THROW(read(""), InputError);
  EXPECT_THROW(read_label_table("missing.txt"), InputError);
}

}  // namespace
}  // namespace podm
