// Every format gives the same small image with its affine. Real images agree with the results of other
// readers (PODM_TEST_IMAGES names their folder).
#include <gtest/gtest.h>
#include <nifti/nifti1_io.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "errors.h"
#include "image/image.h"
#include "image/image_frame.h"
#include "image/size_image.h"
#include "made_files.h"

namespace podm::verify {
namespace {

using Affine = std::array<double, 12>;

const Affine kPlain{1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0};
const Affine kFromLps{-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30};

void expect_small_image(const std::string& path, const Affine& affine) {
  const Image image = read_image(path);
  EXPECT_EQ(image.path, path);
  EXPECT_EQ(image.size, (std::array<int, 3>{2, 3, 4}));
  EXPECT_EQ(image.voxels, two_voxels<std::uint32_t>());
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(image.spacing[axis], std::hypot(affine[axis], affine[4 + axis], affine[8 + axis]), 1e-12);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(image.voxel_to_ras[i], affine[i], 1e-6) << i;
}

TEST(ReadVerifierImage, Nifti) {
  const Folder folder;
  expect_small_image(folder.write("a.nii", nifti_file(kVoxels)), kPlain);
  expect_small_image(folder.write("a.nii.gz", deflated(nifti_file(kVoxels))), kPlain);
  expect_small_image(folder.write("b.nii", nifti_file(kVoxels, [](auto& h) { h.dim[0] = 4; })), kPlain);
}

TEST(ReadVerifierImage, GzipOfSeveralMembers) {
  const Folder folder;
  const std::string file = nifti_file(kVoxels);
  expect_small_image(folder.write("a.nii.gz", deflated(file.substr(0, 360)) + deflated(file.substr(360))),
                     kPlain);
}

TEST(ReadVerifierImage, NiftiQformHalfATurnAboutZ) {
  const Folder folder;
  const std::string file = nifti_file(kVoxels, [](auto& h) {
    h.sform_code = 0;
    h.qform_code = NIFTI_XFORM_SCANNER_ANAT;
    h.quatern_d = 1;
    h.qoffset_x = 4;
  });
  expect_small_image(folder.write("a.nii", file), {-1, 0, 0, 4, 0, -2, 0, 0, 0, 0, 3, 0});
}

// The byte order does not matter. libnifti does not read the file here; it only interprets the quaternion.
TEST(ReadVerifierImage, NiftiQformIsTheRotationThatLibniftiMakesOfIt) {
  const Folder folder;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 100; ++i) {
    std::array<float, 4> q{normal(random), normal(random), normal(random), normal(random)};
    if (i % 4 == 0) q[0] = 0;  // half a turn
    const float norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const float sign = q[0] < 0 ? -1.0F : 1.0F, turn = i % 2 == 0 ? 1.0F : -1.0F;
    nifti_1_header header{};
    const auto change = [&](auto& h) {
      h.sform_code = 0;
      h.qform_code = NIFTI_XFORM_SCANNER_ANAT;
      h.pixdim[0] = turn;
      h.quatern_b = sign * q[1] / norm;
      h.quatern_c = sign * q[2] / norm;
      h.quatern_d = sign * q[3] / norm;
      h.qoffset_x = -40;
      h.qoffset_z = 7;
      header = h;
    };
    std::string file = nifti_file(kVoxels, change);
    const mat44 expected = nifti_quatern_to_mat44(
        header.quatern_b, header.quatern_c, header.quatern_d, header.qoffset_x, header.qoffset_y,
        header.qoffset_z, header.pixdim[1], header.pixdim[2], header.pixdim[3], header.pixdim[0]);
    if (i % 3 == 0) {
      swap_nifti_header(&header, 1);
      std::memcpy(file.data(), &header, sizeof header);
    }
    const Image image = read_image(folder.write("a.nii", file));
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        EXPECT_NEAR(image.voxel_to_ras[4 * row + column], static_cast<double>(expected.m[row][column]), 2e-6);
  }
}

TEST(ReadVerifierImage, ShearIsHonouredAndUnitsAre) {
  const Folder folder;
  const auto sheared = nifti_file(kVoxels, [](auto& h) {
    h.srow_x[1] = 0.5F;
    h.srow_z[3] = -8;
    h.qform_code = NIFTI_XFORM_SCANNER_ANAT;  // without the shear: the sform comes first
  });
  expect_small_image(folder.write("a.nii", sheared), {1, 0.5, 0, 0, 0, 2, 0, 0, 0, 0, 3, -8});
  const auto metres = nifti_file(kVoxels, [](auto& h) { h.xyzt_units = NIFTI_UNITS_METER; });
  expect_small_image(folder.write("b.nii", metres), {1e3, 0, 0, 0, 0, 2e3, 0, 0, 0, 0, 3e3, 0});
}

TEST(ReadVerifierImage, DirectionRoundedToSixDigitsIsIsometric) {
  const Folder folder;
  const Image image = read_image(folder.write("a.nii", nifti_file(kVoxels, [](auto& h) {
                                                h.srow_x[0] = h.srow_y[1] = 0.866025F;
                                                h.srow_x[1] = -0.5F;
                                                h.srow_y[0] = 0.5F;
                                              })));
  const auto& a = image.voxel_to_ras;
  EXPECT_NEAR(a[0] * a[1] + a[4] * a[5] + a[8] * a[9], 0, 1e-15);
  EXPECT_NEAR(a[0], std::sqrt(0.75), 2e-6);
}

TEST(ReadVerifierImage, Inr) {
  const Folder folder;
  const std::string file = inr_header("VX=1\nVY=2\nVZ=3\nTX=-4\n") + kVoxels;
  const Affine affine{1, 0, 0, -4, 0, 2, 0, 0, 0, 0, 3, 0};
  expect_small_image(folder.write("a.inr", file), affine);
  expect_small_image(folder.write("a.inr.gz", deflated(file)), affine);
}

TEST(ReadVerifierImage, Nrrd) {
  const Folder folder;
  const std::string names = "name:=" + std::string(5000, 'v') + "\n#" + std::string(5000, 'c') + "\n";
  expect_small_image(folder.write("a.nrrd", kNrrdHeader + names + "encoding: raw\n\n" + kVoxels), kFromLps);
  expect_small_image(folder.write("b.nrrd", kNrrdHeader + "encoding: gzip\n\n" + deflated(kVoxels)),
                     kFromLps);
  folder.write("c.raw", kVoxels);
  expect_small_image(folder.write("c.nhdr", kNrrdHeader + "encoding: raw\ndata file: c.raw\n\n"), kFromLps);
}

TEST(ReadVerifierImage, MetaImage) {
  const Folder folder;
  const std::string local = "ElementDataFile = LOCAL\n", zipped = deflated(kVoxels, 15);
  expect_small_image(folder.write("a.mha", kMetaHeader + local + kVoxels), kFromLps);
  expect_small_image(
      folder.write("b.mha", "CompressedData = True\nCompressedDataSize = " + std::to_string(zipped.size()) +
                                "\n" + kMetaHeader + local + zipped),
      kFromLps);
  folder.write("c.raw", kVoxels);
  expect_small_image(folder.write("c.mhd", kMetaHeader + "ElementDataFile = c.raw\n"), kFromLps);
}

// Some programs change a file but not its header. In some files more bytes follow the stream.
TEST(ReadVerifierImage, MetaImageWhoseStreamIsNotAsLongAsItsHeaderSays) {
  const Folder folder;
  const std::string zipped = deflated(kVoxels, 15), size = std::to_string(zipped.size());
  for (const std::string& announced : {std::string("1"), std::string("123456"), size}) {
    for (const std::string& tail : {std::string(), std::string("more")}) {
      const std::string path =
          folder.write("a.mha", "CompressedData = True\nCompressedDataSize = " + announced + "\n" +
                                    kMetaHeader + "ElementDataFile = LOCAL\n" + zipped + tail);
      expect_small_image(path, kFromLps);
      const Image image = read_image(path);
      ASSERT_EQ(image.warnings.size(), announced == size ? 0u : 1u);
      if (announced == size) continue;
      EXPECT_TRUE(image.warnings[0].starts_with(path + ": ")) << image.warnings[0];
      EXPECT_NE(image.warnings[0].find(announced), std::string::npos) << image.warnings[0];
      EXPECT_NE(image.warnings[0].find(size), std::string::npos) << image.warnings[0];
    }
  }
}

template <class T>
void expect_type(const Folder& folder, int datatype) {
  const std::string file = nifti_file(bytes_of_values(two_voxels<T>()),
                                      [&](auto& h) { h.datatype = static_cast<short>(datatype); });
  expect_small_image(folder.write("a.nii", file), kPlain);
}

TEST(ReadVerifierImage, EveryTypeThatHoldsLabels) {
  const Folder folder;
  expect_type<std::int8_t>(folder, DT_INT8);
  expect_type<std::uint16_t>(folder, DT_UINT16);
  expect_type<std::int16_t>(folder, DT_INT16);
  expect_type<std::uint32_t>(folder, DT_UINT32);
  expect_type<std::int32_t>(folder, DT_INT32);
  expect_type<std::uint64_t>(folder, DT_UINT64);
  expect_type<std::int64_t>(folder, DT_INT64);
  expect_type<float>(folder, DT_FLOAT32);
  expect_type<double>(folder, DT_FLOAT64);
}

TEST(ReadVerifierImage, BytesOfTheOtherOrder) {
  const Folder folder;
  auto voxels = two_voxels<std::uint16_t>();
  for (auto& v : voxels) v = static_cast<std::uint16_t>(v << 8);
  const std::string bytes = bytes_of_values(voxels);
  expect_small_image(folder.write("a.inr", inr_header("VX=1\nVY=2\nVZ=3\n",
                                                      "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\nTYPE=unsigned "
                                                      "fixed\nPIXSIZE=16 bits\nCPU=sun\n") +
                                               bytes),
                     kPlain);
  const std::string nrrd =
      replaced(replaced(kNrrdHeader, "uchar", "ushort"), "endian: little", "endian: big") +
      "encoding: raw\n\n";
  expect_small_image(folder.write("a.nrrd", nrrd + bytes), kFromLps);
  const std::string meta = replaced(replaced(kMetaHeader, "UCHAR", "USHORT"), "MSB = False", "MSB = True") +
                           "ElementDataFile = LOCAL\n";
  expect_small_image(folder.write("a.mha", meta + bytes), kFromLps);
}

TEST(ReadVerifierImage, IntegersOf64BitsInNrrdAndMetaImage) {
  const Folder folder;
  auto voxels = two_voxels<std::int64_t>();
  const auto nrrd = [&](const char* type) {
    return replaced(kNrrdHeader, "uchar", type) + "encoding: raw\n\n" + bytes_of_values(voxels);
  };
  const auto meta = [&](const char* type) {
    return replaced(kMetaHeader, "MET_UCHAR", type) + "ElementDataFile = LOCAL\n" + bytes_of_values(voxels);
  };
  for (const char* type : {"int64", "uint64", "long long int"})
    expect_small_image(folder.write("a.nrrd", nrrd(type)), kFromLps);
  for (const char* type : {"MET_LONG_LONG", "MET_ULONG_LONG"})
    expect_small_image(folder.write("a.mha", meta(type)), kFromLps);
  for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{1} << 32, std::int64_t{1} << 62}) {
    voxels[2] = value;
    for (const std::string& path :
         {folder.write("b.nrrd", nrrd("int64")), folder.write("b.mha", meta("MET_LONG_LONG"))}) {
      try {
        read_image(path);
        ADD_FAILURE() << path << " was read";
      } catch (const InputError& error) {
        const std::string expected = "voxel (0, 1, 0) has the value " + std::to_string(value);
        EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      }
    }
  }
}

TEST(ReadVerifierSizeImage, TakesAnyNumberScaledAsTheHeaderSays) {
  const Folder folder;
  std::vector<double> values(24);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) - 3;
  values[20] = std::numeric_limits<double>::infinity();
  const std::string bytes = bytes_of_values(values);
  const auto scaled = [](auto& h) { h.datatype = DT_FLOAT64, h.scl_slope = 0.5F, h.scl_inter = 0.25F; };
  const SizeImage image = read_size_image(folder.write("a.nii", nifti_file(bytes, scaled)));
  EXPECT_EQ(image.size, (std::array<int, 3>{2, 3, 4}));
  ASSERT_EQ(image.radius_mm.size(), 24);
  EXPECT_EQ(image.radius_mm[0], 0) << "a negative number is no bound";
  EXPECT_EQ(image.radius_mm[3], 0.25F);
  EXPECT_EQ(image.radius_mm[23], 10.25F);
  EXPECT_EQ(image.radius_mm[20], 0) << "nor is infinity";
  EXPECT_THROW(read_image(folder.write("b.nii", nifti_file(bytes, scaled))), InputError);
}

TEST(ReadVerifierSizeImage, NamesTheVoxelThatIsNotANumber) {
  const Folder folder;
  std::vector<float> values(24, 1);
  values[1 + 2 * (2 + 3 * 3)] = std::numeric_limits<float>::quiet_NaN();
  const auto floats = [](auto& h) { h.datatype = DT_FLOAT32; };
  try {
    read_size_image(folder.write("a.nii", nifti_file(bytes_of_values(values), floats)));
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what()).find("a.nii: a size image is needed: voxel (1, 2, 3) is not a number"),
        std::string::npos)
        << error.what();
  }
}

struct Measured {
  const char* file;
  std::array<int, 3> size;
  std::size_t labels, labelled_voxels;
  double labelled_mm3;
};

class RealVerifierImage : public testing::TestWithParam<Measured> {};

TEST_P(RealVerifierImage, IsReadAsMeasured) {
  const char* folder = std::getenv("PODM_TEST_IMAGES");
  if (folder == nullptr) GTEST_SKIP() << "skipped: PODM_TEST_IMAGES is not set";
  const Measured& measured = GetParam();
  const Image image = read_image((std::filesystem::path(folder) / measured.file).string());
  EXPECT_EQ(image.size, measured.size);
  std::map<std::uint32_t, std::size_t> counts;
  for (const std::uint32_t label : image.voxels) ++counts[label];
  EXPECT_EQ(counts.size(), measured.labels + 1);
  const std::size_t labelled = image.voxels.size() - counts[0];
  EXPECT_EQ(labelled, measured.labelled_voxels);
  EXPECT_NEAR(static_cast<double>(labelled) * ImageFrame(image, Space::kRas).voxel_volume_mm3(),
              measured.labelled_mm3, 5e-6 * measured.labelled_mm3);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealVerifierImage,
    testing::Values(Measured{"abdomen_ct_spl.nrrd", {256, 256, 113}, 95, 1446889, 1.90752e6},
                    Measured{"head_mri_colin27.nii.gz", {181, 217, 181}, 6, 4040490, 4.04049e6},
                    Measured{"brain_mri_spl.nrrd", {256, 256, 256}, 312, 1724004, 1.72400e6},
                    Measured{"liver_cgal.inr.gz", {438, 353, 165}, 4, 3492286, 1.77371e6},
                    Measured{"abdomen_ct_slab.nii.gz", {512, 512, 20}, 31, 739420, 1.41033e6},
                    Measured{"abdomen_ct_small.nii.gz", {122, 101, 30}, 41, 110225, 2.97608e6},
                    Measured{"abdomen_mr_small.nii.gz", {117, 91, 20}, 23, 44034, 1.18892e6},
                    Measured{"abdomen_mr_small.mha", {117, 91, 20}, 23, 44034, 1.18892e6}),
    [](const auto& param_info) {
      std::string name = param_info.param.file;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

}  // namespace
}  // namespace podm::verify
