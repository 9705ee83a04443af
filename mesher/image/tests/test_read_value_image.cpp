// Images of values: voxels of any type, scaled as in the header; other values are refused with file and
// voxel.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image/tests/image_files.h"
#include "podm/image_io.h"
#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

// A NIfTI file of 24 voxels.
template <class T>
std::string file_of(short datatype, const std::vector<T>& voxels, float slope = 0, float intercept = 0) {
  nifti_1_header header = nifti_header();
  header.datatype = datatype;
  header.bitpix = 8 * sizeof(T);
  header.scl_slope = slope;
  header.scl_inter = intercept;
  return nifti_file(header, bytes_of_values(voxels));
}

template <class T>
std::vector<T> counted(T first) {
  std::vector<T> voxels(24);
  for (std::size_t i = 0; i < 24; ++i) voxels[i] = static_cast<T>(first + static_cast<T>(i));
  return voxels;
}

TEST(ReadValueImage, KeepsValuesInSinglePrecisionIfItHoldsThem) {
  const ScratchFolder folder;
  const ValueImage image =
      read_value_image(folder.write("a.nii", file_of<std::int16_t>(DT_INT16, counted<std::int16_t>(-12))));
  const auto& values = std::get<std::vector<float>>(image.values);
  ASSERT_EQ(values.size(), 24u);
  EXPECT_EQ(values.size(), static_cast<std::size_t>(image.size[0] * image.size[1] * image.size[2]));
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(values[i], -12 + static_cast<float>(i));
}

TEST(ReadValueImage, KeepsOtherValuesInDoublePrecision) {
  const ScratchFolder folder;
  const ValueImage large = read_value_image(
      folder.write("a.nii", file_of<std::int32_t>(DT_INT32, counted<std::int32_t>(1 << 24))));
  for (std::size_t i = 0; i < 24; ++i)
    EXPECT_EQ(std::get<std::vector<double>>(large.values).at(i), (1 << 24) + static_cast<double>(i));
  const ValueImage scaled = read_value_image(
      folder.write("b.nii", file_of<std::int16_t>(DT_INT16, counted<std::int16_t>(0), 0.1f, -5)));
  for (std::size_t i = 0; i < 24; ++i)
    EXPECT_EQ(std::get<std::vector<double>>(scaled.values).at(i), double{0.1f} * static_cast<double>(i) - 5);
}

TEST(ReadValueImage, RefusesValuesThatAreNotFinite) {
  const ScratchFolder folder;
  for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    std::vector<float> voxels = counted<float>(1);
    voxels.at(7) = value;
    const std::string path = folder.write("a.nii", file_of<float>(DT_FLOAT32, voxels));
    const std::string fault = fault_of<InputError>([&] { read_value_image(path); });
    EXPECT_TRUE(fault.starts_with(path + ": ")) << fault;
    EXPECT_NE(fault.find("voxel ("), std::string::npos) << fault;
  }
}

TEST(ReadValueImage, RefusesWhatTakesMoreThanTheMemory) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.nii", file_of<float>(DT_FLOAT32, counted<float>(1)));
  EXPECT_NO_THROW(read_value_image(path, 1 << 20));
  EXPECT_NE(fault_of<InputError>([&] { read_value_image(path, 24 * 4 + 10); }).find(path), std::string::npos);
}

}  // namespace
}  // namespace podm
