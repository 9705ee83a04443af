#include <gtest/gtest.h>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Names = std::map<std::uint32_t, std::string>;

TEST(LabelNames, ItkSnapTable) {
  const ScratchFolder folder;
  EXPECT_EQ(read_label_names(folder.write("labels.txt",
                                          "# IDX -R- -G- -B- -A-- VIS MSH LABEL\r\n"
                                          "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
                                          "\n"
                                          "   17   255    0    0        1  1  1    \"left kidney #2\"\r\n")),
            (Names{{0, "Clear Label"}, {17, "left kidney #2"}}));
}

TEST(LabelNames, ValueAndNameLines) {
  const ScratchFolder folder;
  EXPECT_EQ(read_label_names(folder.write("aal.txt", "1 Precentral_L 2001\n2\tPrecentral_R\n")),
            (Names{{1, "Precentral_L"}, {2, "Precentral_R"}}));
}

TEST(LabelNames, FaultsNameTheLine) {
  const ScratchFolder folder;
  for (const char* line : {"Precentral_L 1", "-1 name", "4294967296 name", "1", "2x name", "1 \"\""}) {
    const std::string path = folder.write("labels.txt", std::string("7 fine\n") + line + "\n");
    try {
      read_label_names(path);
      ADD_FAILURE() << "'" << line << "' was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path + ":2: "), std::string::npos) << error.what();
    }
  }
}

TEST(LabelNames, AFileWithoutNamesIsRefused) {
  const ScratchFolder folder;
  EXPECT_THROW(read_label_names(folder.write("labels.txt", "# nothing\n")), InputError);
  EXPECT_THROW(read_label_names(folder.write("labels.txt", "")), InputError);
  EXPECT_THROW(read_label_names("missing.txt"), InputError);
}

}  // namespace
}  // namespace podm
