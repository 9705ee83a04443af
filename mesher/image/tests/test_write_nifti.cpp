#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/full_disk.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Affine = std::array<double, 12>;
constexpr Affine kAxisAligned{0.5, 0, 0, -7, 0, 0.75, 0, 11, 0, 0, 2, -3};
constexpr Affine kSheared{0.5, 0.2, 0, -7, 0, 0.75, 0.5, 11, 0.1, 0, 2, -3};

// An affine turned about all three axes, with the spacings of kAxisAligned. `mirror` is 1 or -1.
Affine oblique(double mirror) {
  const double ca = std::cos(0.3), sa = std::sin(0.3), cb = std::cos(-0.5), sb = std::sin(-0.5);
  const double cc = std::cos(1.1), sc = std::sin(1.1);
  const double x = 0.5 * mirror, y = 0.75, z = 2;
  return {x * cb * cc,
          y * (sa * sb * cc - ca * sc),
          z * (ca * sb * cc + sa * sc),
          -7,  //
          x * cb * sc,
          y * (sa * sb * sc + ca * cc),
          z * (ca * sb * sc - sa * cc),
          11,  //
          x * -sb,
          y * sa * cb,
          z * ca * cb,
          -3};
}

// An image of 5 x 4 x 3 voxels that contains each label at least once.
LabelImage image_of(const std::vector<std::uint32_t>& values, const Affine& affine = kAxisAligned) {
  LabelImage image;
  image.size = {5, 4, 3};
  image.voxel_to_ras = affine;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    image.spacing[axis] = std::hypot(affine[axis], affine[4 + axis], affine[8 + axis]);
  }
  image.labels = {{0, ""}};
  for (const std::uint32_t value : values) image.labels.push_back({value, ""});
  std::mt19937 random(7);
  for (std::size_t i = 0; i < image.num_voxels(); ++i) {
    image.voxels.push_back(
        static_cast<LabelIndex>(i < image.labels.size() ? i : random() % image.labels.size()));
  }
  return image;
}

std::vector<std::uint32_t> values_of_voxels(const LabelImage& image) {
  std::vector<std::uint32_t> values;
  for (const LabelIndex index : image.voxels) values.push_back(image.labels[index].value);
  return values;
}

void expect_same(const LabelImage& read, const LabelImage& written) {
  EXPECT_EQ(read.size, written.size);
  EXPECT_EQ(values_of_voxels(read), values_of_voxels(written));
  constexpr double kFloatPrecision = 1e-6;
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(read.voxel_to_ras[i], written.voxel_to_ras[i],
                kFloatPrecision * std::max(1.0, std::abs(written.voxel_to_ras[i])));
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(read.spacing[i], written.spacing[i], kFloatPrecision);
}

nifti_1_header header_in(const std::string& path) {
  nifti_1_header header{};
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
  return header;
}

class WriteNifti : public testing::TestWithParam<std::string> {
 protected:
  // The path of a file of this name that contains "older".
  std::string path() const { return folder_.write("image" + GetParam(), "older"); }
  ScratchFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Extensions, WriteNifti, testing::Values(".nii", ".nii.gz"),
                         [](const auto& extension) {
                           return extension.param == ".nii" ? "plain" : "compressed";
                         });

TEST_P(WriteNifti, LabelValuesReadBackHoweverLarge) {
  for (const auto& values : std::vector<std::vector<std::uint32_t>>{
           {1, 255}, {3, 256}, {65535}, {1, 65536}, {7, 2147483647}, {2, 2147483648, 4294967295}}) {
    SCOPED_TRACE(values.back());
    const std::string file = path();
    write_nifti(image_of(values), file);
    expect_same(read_image(file), image_of(values));
  }
}

TEST_P(WriteNifti, AnyAffineReadsBack) {
  for (const Affine& affine : {kAxisAligned, oblique(1), oblique(-1), kSheared}) {
    const std::string file = path();
    write_nifti(image_of({1, 2}, affine), file);
    expect_same(read_image(file), image_of({1, 2}, affine));
  }
}

TEST_P(WriteNifti, APhantomReadsBack) {
  const LabelImage phantom = make_phantom("abdomen", 48);
  const std::string file = path();
  write_nifti(phantom, file);
  expect_same(read_image(file), phantom);
}

TEST_P(WriteNifti, NothingButTheFileIsLeft) {
  const std::string file = path();
  write_nifti(image_of({1}), file);
  EXPECT_EQ(folder_.files(), std::set<std::string>{"image" + GetParam()});
}

TEST_P(WriteNifti, AFullDiskIsReportedAndLeavesTheOlderFile) {
  const LabelImage phantom = make_phantom("abdomen", 64);
  const std::string file = path();
  for (const rlim_t bytes : {0, 100, 2000}) {
    try {
      const FullDisk disk(bytes);
      write_nifti(phantom, file);
      ADD_FAILURE() << "no error at " << bytes << " bytes";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("File too large"), std::string::npos) << error.what();
    }
    EXPECT_EQ(folder_.files(), std::set<std::string>{"image" + GetParam()});
    EXPECT_EQ(folder_.read("image" + GetParam()), "older");
  }
}

TEST_P(WriteNifti, AMissingFolderAndAFolderInTheWayAreReported) {
  EXPECT_THROW(write_nifti(image_of({1}), folder_ / ("none/image" + GetParam())), InputError);
  const std::string taken = folder_ / ("taken" + GetParam());
  std::filesystem::create_directory(taken);
  EXPECT_THROW(write_nifti(image_of({1}), taken), InputError);
  EXPECT_EQ(folder_.files().size(), 1u);
}

TEST(WriteNiftiHeader, VoxelsTakeTheSmallestTypeThatHoldsThem) {
  const ScratchFolder folder;
  const std::string file = folder.write("image.nii", "");
  const std::map<std::uint32_t, int> type_of{{255, DT_UINT8},        {256, DT_UINT16},
                                             {65535, DT_UINT16},     {65536, DT_INT32},
                                             {2147483647, DT_INT32}, {2147483648, DT_UINT32}};
  for (const auto& [value, type] : type_of) {
    write_nifti(image_of({value}), file);
    const nifti_1_header header = header_in(file);
    EXPECT_EQ(header.datatype, type) << value;
    EXPECT_EQ(std::filesystem::file_size(file), 352u + 60u * static_cast<unsigned>(header.bitpix) / 8)
        << value;
  }
}

TEST(WriteNiftiHeader, WithoutItsSformTheQformGivesTheAffine) {
  const ScratchFolder folder;
  const std::string file = folder.write("image.nii", "");
  for (const Affine& affine : {kAxisAligned, oblique(1), oblique(-1)}) {
    write_nifti(image_of({1}, affine), file);
    nifti_1_header header = header_in(file);
    EXPECT_GT(header.sform_code, 0);
    header.sform_code = 0;
    const LabelImage read =
        read_image(folder.write("q.nii", nifti_file(header, folder.read("image.nii").substr(352))));
    for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(read.voxel_to_ras[i], affine[i], 1e-5) << i;
  }
}

TEST(WriteNiftiHeader, AShearedAffineHasNoQuaternion) {
  const ScratchFolder folder;
  const std::string file = folder.write("image.nii", "");
  write_nifti(image_of({1}, kSheared), file);
  EXPECT_GT(header_in(file).sform_code, 0);
  EXPECT_EQ(header_in(file).qform_code, 0);
}

TEST(WriteNiftiPath, OtherExtensionsAreRefused) {
  const ScratchFolder folder;
  for (const std::string extension : {"", ".gz", ".nrrd", ".nii.bz2", ".NII"}) {
    EXPECT_THROW(write_nifti(image_of({1}), folder / ("image" + extension)), InputError) << extension;
  }
  EXPECT_TRUE(folder.files().empty());
}

TEST(WriteNiftiPath, AnAxisBeyondTheFormatIsRefused) {
  const ScratchFolder folder;
  const std::string file = folder.write("image.nii", "older");
  LabelImage image = image_of({1});
  image.size = {32768, 1, 1};
  image.voxels.assign(32768, 1);
  EXPECT_THROW(write_nifti(image, file), InputError);
  EXPECT_EQ(folder.read("image.nii"), "older");
}

}  // namespace
}  // namespace podm
