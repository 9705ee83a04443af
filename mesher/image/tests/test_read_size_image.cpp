// Size images: values of any type become radii, values that are not a bound become 0, and faults are reported
// with file and voxel.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

class ReadSizeImage : public ::testing::Test {
 protected:
  SizeImage read(const std::string& name, const std::string& bytes) {
    return read_size_image(folder_.write(name, bytes));
  }
  std::string refusal(const std::string& name, const std::string& bytes) {
    const std::string path = folder_.write(name, bytes);
    try {
      read_size_image(path);
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with(path + ": ")) << text;
      return text;
    }
    return "was read";
  }

  ScratchFolder folder_;
};

template <class T>
std::string nifti_of_sizes(
    short datatype, const std::vector<T>& voxels,
    const std::function<void(nifti_1_header&)>& change = [](nifti_1_header&) {}) {
  nifti_1_header header = nifti_header();
  header.datatype = datatype;
  header.bitpix = 8 * sizeof(T);
  change(header);
  return nifti_file(header, bytes_of_values(voxels));
}

// 24 voxels with the values 1 to 24.
template <class T>
std::vector<T> counted() {
  std::vector<T> voxels(24);
  for (std::size_t i = 0; i < 24; ++i) voxels[i] = static_cast<T>(i + 1);
  return voxels;
}

void expect_counted(const SizeImage& image, float scale = 1) {
  ASSERT_EQ(image.radius_mm.size(), 24);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(image.radius_mm[i], scale * static_cast<float>(i + 1));
}

TEST_F(ReadSizeImage, TakesAnyNumber) {
  expect_counted(read("a.nii", nifti_of_sizes(DT_FLOAT32, counted<float>())));
  expect_counted(read("b.nii", nifti_of_sizes(DT_FLOAT64, counted<double>())));
  expect_counted(read("c.nii.gz", deflated(nifti_of_sizes(DT_INT16, counted<std::int16_t>()))));
  expect_counted(read("d.nii", nifti_of_sizes(DT_UINT8, counted<std::uint8_t>())));
  expect_counted(read(
      "e.inr", inr_header("", "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\n", "TYPE=float\nPIXSIZE=64 bits\nCPU=decm\n") +
                   bytes_of_values(counted<double>())));
  expect_counted(
      read("f.mha", mha_header("TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\n"
                               "ElementSpacing = 1 2 3\nDimSize = 2 3 4\nElementType = MET_FLOAT\n" +
                               kMhaLocal) +
                        bytes_of_values(counted<float>())));
}

TEST_F(ReadSizeImage, HasAGridOfItsOwn) {
  const SizeImage image = read("a.nii", nifti_of_sizes(DT_FLOAT32, counted<float>()));
  EXPECT_EQ(image.size, (std::array<int, 3>{2, 3, 4}));
  EXPECT_EQ(image.voxel_to_ras, (std::array<double, 12>{1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0}));
}

TEST_F(ReadSizeImage, ScalesAsTheHeaderSays) {
  const auto scale = [](nifti_1_header& h) { h.scl_slope = 0.5F, h.scl_inter = 0; };
  expect_counted(read("a.nii", nifti_of_sizes(DT_UINT8, counted<std::uint8_t>(), scale)), 0.5F);
  const auto shift = [](nifti_1_header& h) { h.scl_slope = 2, h.scl_inter = 1; };
  EXPECT_EQ(read("b.nii", nifti_of_sizes(DT_INT16, counted<std::int16_t>(), shift)).radius_mm[3], 9);
}

TEST_F(ReadSizeImage, TakesWhatIsNotAboveZeroForNoBound) {
  auto voxels = counted<double>();
  voxels[0] = 0;
  voxels[1] = -3;
  voxels[2] = std::numeric_limits<double>::infinity();
  voxels[3] = 1e300;  // beyond single precision
  const SizeImage image = read("a.nii", nifti_of_sizes(DT_FLOAT64, voxels));
  for (const std::size_t i : {0U, 1U, 2U, 3U}) EXPECT_EQ(image.radius_mm[i], 0);
  EXPECT_EQ(image.radius_mm[4], 5);
}

TEST_F(ReadSizeImage, NamesTheVoxelThatIsNotANumber) {
  auto voxels = counted<float>();
  voxels[1 + 2 * (2 + 3 * 3)] = std::numeric_limits<float>::quiet_NaN();
  const std::string text = refusal("a.nii", nifti_of_sizes(DT_FLOAT32, voxels));
  EXPECT_NE(text.find("voxel (1, 2, 3) is not a number"), std::string::npos) << text;
}

TEST_F(ReadSizeImage, RefusesWhatBoundsNothing) {
  const std::string text = refusal("a.nii", nifti_of_sizes(DT_FLOAT32, std::vector<float>(24, -1)));
  EXPECT_NE(text.find("no voxel has a size above 0 mm"), std::string::npos) << text;
}

TEST_F(ReadSizeImage, RefusesWhatIsNotThreeDimensional) {
  const auto flatten = [](nifti_1_header& h) { h.dim[0] = 2; };
  EXPECT_NE(
      refusal("a.nii", nifti_of_sizes(DT_FLOAT32, counted<float>(), flatten)).find("a 3-D image is needed"),
      std::string::npos);
  const auto lengthen = [](nifti_1_header& h) {
    h.dim[0] = 4;
    h.dim[3] = 2;
    h.dim[4] = 2;
  };
  EXPECT_NE(
      refusal("b.nii", nifti_of_sizes(DT_FLOAT32, counted<float>(), lengthen)).find("a 3-D image is needed"),
      std::string::npos);
}

TEST_F(ReadSizeImage, RefusesFilesThatAreNoImages) {
  EXPECT_NE(refusal("a.nii", "nothing").find("truncated"), std::string::npos);
  EXPECT_NE(refusal("a.txt", "1 2 3").find("unknown image format"), std::string::npos);
}

}  // namespace
}  // namespace podm
