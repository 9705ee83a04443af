// Compares real images with measurements by other readers. PODM_TEST_IMAGES is the folder of the images.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "podm/image_io.h"

namespace podm {
namespace {

std::string real_image(const std::string& name) {
  const char* folder = std::getenv("PODM_TEST_IMAGES");
  return folder == nullptr ? "" : (std::filesystem::path(folder) / name).string();
}

double voxel_volume_mm3(const LabelImage& image) {
  const auto& a = image.voxel_to_ras;
  return std::abs(a[0] * (a[5] * a[10] - a[6] * a[9]) - a[1] * (a[4] * a[10] - a[6] * a[8]) +
                  a[2] * (a[4] * a[9] - a[5] * a[8]));
}

struct Measured {
  const char* file;
  std::array<int, 3> size;
  std::array<double, 3> spacing;
  std::size_t labels;  // without the background
  std::uint32_t largest_value;
  std::size_t labelled_voxels;
  double labelled_mm3;
};

class RealImage : public testing::TestWithParam<Measured> {};

TEST_P(RealImage, IsReadAsMeasured) {
  const Measured& measured = GetParam();
  const std::string path = real_image(measured.file);
  if (path.empty()) GTEST_SKIP() << "skipped: PODM_TEST_IMAGES is not set";
  const LabelImage image = read_image(path);
  EXPECT_EQ(image.size, measured.size);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(image.spacing[axis], measured.spacing[axis], 5e-6 * measured.spacing[axis]);
  EXPECT_EQ(image.labels.size(), measured.labels + 1);
  EXPECT_EQ(image.labels[kBackground].value, 0u);
  EXPECT_EQ(image.labels.back().value, measured.largest_value);
  ASSERT_EQ(image.voxels.size(), image.num_voxels());
  std::vector<std::size_t> counts(image.labels.size());
  for (const LabelIndex label : image.voxels) {
    ASSERT_LT(label, image.labels.size());
    ++counts[label];
  }
  for (std::size_t label = 1; label < counts.size(); ++label) {
    EXPECT_GT(counts[label], 0u);
    EXPECT_LT(image.labels[label - 1].value, image.labels[label].value);
  }
  const std::size_t labelled = image.voxels.size() - counts[kBackground];
  EXPECT_EQ(labelled, measured.labelled_voxels);
  EXPECT_NEAR(static_cast<double>(labelled) * voxel_volume_mm3(image), measured.labelled_mm3,
              5e-6 * measured.labelled_mm3);
}

INSTANTIATE_TEST_SUITE_P(
    ReadImage, RealImage,
    testing::Values(
        Measured{"abdomen_ct_spl.nrrd", {256, 256, 113}, {0.9375, 0.9375, 1.5}, 95, 699, 1446889, 1.90752e6},
        Measured{"head_mri_colin27.nii.gz", {181, 217, 181}, {1, 1, 1}, 6, 6, 4040490, 4.04049e6},
        Measured{"brain_mri_spl.nrrd", {256, 256, 256}, {1, 1, 1}, 312, 4100, 1724004, 1.72400e6},
        Measured{
            "liver_cgal.inr.gz", {438, 353, 165}, {0.617188, 0.617188, 1.33333}, 4, 255, 3492286, 1.77371e6},
        Measured{
            "abdomen_ct_slab.nii.gz", {512, 512, 20}, {0.976562, 0.976562, 2}, 31, 117, 739420, 1.41033e6},
        Measured{"abdomen_ct_small.nii.gz", {122, 101, 30}, {3, 3, 3}, 41, 117, 110225, 2.97608e6},
        Measured{"abdomen_mr_small.nii.gz", {117, 91, 20}, {3, 3, 3}, 23, 49, 44034, 1.18892e6},
        Measured{"abdomen_mr_small.mha", {117, 91, 20}, {3, 3, 3}, 23, 49, 44034, 1.18892e6}),
    [](const auto& param_info) {
      std::string name = param_info.param.file;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

TEST(RealImages, TwoFormatsOfOneImageGiveTheSameImage) {
  const std::string nifti_path = real_image("abdomen_mr_small.nii.gz");
  if (nifti_path.empty()) GTEST_SKIP() << "skipped: PODM_TEST_IMAGES is not set";
  const LabelImage nifti = read_image(nifti_path), meta = read_image(real_image("abdomen_mr_small.mha"));
  EXPECT_EQ(nifti.voxels, meta.voxels);
  ASSERT_EQ(nifti.labels.size(), meta.labels.size());
  for (std::size_t i = 0; i < nifti.labels.size(); ++i)
    EXPECT_EQ(nifti.labels[i].value, meta.labels[i].value);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(nifti.voxel_to_ras[i], meta.voxel_to_ras[i], 1e-3);
}

}  // namespace
}  // namespace podm
