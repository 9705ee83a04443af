// Reads one small image in each format: the same voxels, at the right place in the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

class ReadImage : public testing::Test {
 protected:
  ScratchFolder folder_;
};

// Values 7 and 5 at the first two voxels, background elsewhere.
void expect_two_voxels(const LabelImage& image) {
  EXPECT_EQ(image.size, (std::array<int, 3>{2, 3, 4}));
  ASSERT_EQ(image.labels.size(), 3u);
  EXPECT_EQ(image.labels[0].value, 0u);
  EXPECT_EQ(image.labels[1].value, 5u);
  EXPECT_EQ(image.labels[2].value, 7u);
  ASSERT_EQ(image.voxels.size(), 24u);
  EXPECT_EQ(image.voxels[0], 2);
  EXPECT_EQ(image.voxels[1], 1);
  EXPECT_TRUE(std::all_of(image.voxels.begin() + 2, image.voxels.end(),
                          [](LabelIndex v) { return v == kBackground; }));
}

void expect_affine(const LabelImage& image, const std::array<double, 12>& affine, double tolerance = 1e-6) {
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_NEAR(image.voxel_to_ras[i], affine[i], tolerance) << "entry " << i;
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(image.spacing[axis], std::hypot(affine[axis], affine[4 + axis], affine[8 + axis]), tolerance);
}

constexpr std::array<double, 12> kRas{1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0};
constexpr std::array<double, 12> kRasFromLps{-1, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30};

TEST_F(ReadImage, Nifti) {
  const std::string file = nifti_file(nifti_header(), kVoxels);
  for (const auto& [name, bytes] : {std::pair{"a.nii", file}, std::pair{"a.nii.gz", deflated(file)}}) {
    const LabelImage image = read_image(folder_.write(name, bytes));
    expect_two_voxels(image);
    expect_affine(image, kRas);
  }
}

TEST_F(ReadImage, NiftiQformOnly) {
  nifti_1_header header = nifti_header();
  header.sform_code = 0;
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.quatern_d = 1;  // half a turn about z
  header.qoffset_x = 4;
  const LabelImage image = read_image(folder_.write("a.nii", nifti_file(header, kVoxels)));
  expect_two_voxels(image);
  expect_affine(image, {-1, 0, 0, 4, 0, -2, 0, 0, 0, 0, 3, 0});
}

TEST_F(ReadImage, NiftiOfFourDimensionsOfWhichTheLastIsOne) {
  nifti_1_header header = nifti_header();
  header.dim[0] = 4;
  expect_two_voxels(read_image(folder_.write("a.nii", nifti_file(header, kVoxels))));
}

TEST_F(ReadImage, ShearedNiftiKeepsItsShear) {
  nifti_1_header header = nifti_header();
  header.srow_x[1] = 0.5F;  // the y axis leans towards x
  header.srow_z[3] = -8;
  for (const bool zipped : {false, true}) {
    const std::string file = nifti_file(header, kVoxels);
    const LabelImage image =
        read_image(zipped ? folder_.write("a.nii.gz", deflated(file)) : folder_.write("a.nii", file));
    expect_two_voxels(image);
    expect_affine(image, {1, 0.5, 0, 0, 0, 2, 0, 0, 0, 0, 3, -8});
  }
}

TEST_F(ReadImage, ShearedSformIsPreferredToTheQform) {
  nifti_1_header header = nifti_header();
  header.srow_x[1] = 0.5F;
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;  // unsheared
  const LabelImage image = read_image(folder_.write("a.nii", nifti_file(header, kVoxels)));
  expect_affine(image, {1, 0.5, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0});
}

TEST_F(ReadImage, RoundedRotationBecomesIsometric) {
  nifti_1_header header = nifti_header();
  const float c = 0.866025F, s = 0.5F;  // six digits
  header.srow_x[0] = c;
  header.srow_x[1] = -2 * s;
  header.srow_y[0] = s;
  header.srow_y[1] = 2 * c;
  const LabelImage image = read_image(folder_.write("a.nii", nifti_file(header, kVoxels)));
  const auto& a = image.voxel_to_ras;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = a[i] * a[j] + a[4 + i] * a[4 + j] + a[8 + i] * a[8 + j];
      EXPECT_NEAR(product / (image.spacing[i] * image.spacing[j]), i == j ? 1 : 0, 1e-14);
    }
  EXPECT_NEAR(a[0], std::cos(std::acos(-1) / 6), 2e-6);
}

TEST_F(ReadImage, BigEndianNifti) {
  nifti_1_header header = nifti_header();
  std::vector<std::int16_t> voxels(24, 0);
  voxels[0] = 0x0700;  // 7 and 5 with swapped bytes
  voxels[1] = 0x0500;
  const auto swap = [](auto& field) {
    auto* bytes = reinterpret_cast<char*>(&field);
    std::reverse(bytes, bytes + sizeof field);
  };
  header.datatype = DT_INT16;
  header.bitpix = 16;
  swap(header.sizeof_hdr);
  swap(header.datatype);
  swap(header.bitpix);
  swap(header.vox_offset);
  swap(header.sform_code);
  for (auto& n : header.dim) swap(n);
  for (auto& d : header.pixdim) swap(d);
  for (auto* row : {header.srow_x, header.srow_y, header.srow_z})
    for (int i = 0; i < 4; ++i) swap(row[i]);
  const LabelImage image = read_image(folder_.write("a.nii", nifti_file(header, bytes_of_values(voxels))));
  expect_two_voxels(image);
  expect_affine(image, kRas);
}

TEST_F(ReadImage, Nrrd) {
  const std::string names = "name:=" + std::string(5000, 'v') + "\n#" + std::string(5000, 'c') + "\n";
  const std::string raw = nrrd_header(names + kNrrdFields + "encoding: raw\n") + kVoxels;
  const std::string zipped = nrrd_header(kNrrdFields + "encoding: gzip\n") + deflated(kVoxels);
  for (const std::string& file : {raw, zipped}) {
    const LabelImage image = read_image(folder_.write("a.nrrd", file));
    expect_two_voxels(image);
    expect_affine(image, kRasFromLps);
  }
}

TEST_F(ReadImage, NrrdWithItsVoxelsBeside) {
  folder_.write("a.raw", kVoxels);
  const LabelImage image =
      read_image(folder_.write("a.nhdr", nrrd_header(kNrrdFields + "encoding: raw\ndata file: a.raw\n")));
  expect_two_voxels(image);
  expect_affine(image, kRasFromLps);
}

TEST_F(ReadImage, MetaImage) {
  const std::string zipped = deflated(kVoxels, 15);
  const std::string compressed =
      "CompressedData = True\nCompressedDataSize = " + std::to_string(zipped.size()) + "\n";
  const std::string longest = "Comment = " + std::string(244, 'c') + "\n" + std::string(250, 'n') + " = 1\n";
  for (const std::string& file :
       {mha_header(kMhaFields + kMhaLocal) + kVoxels, mha_header(longest + kMhaFields + kMhaLocal) + kVoxels,
        mha_header(compressed + kMhaFields + kMhaLocal) + zipped}) {
    const LabelImage image = read_image(folder_.write("a.mha", file));
    expect_two_voxels(image);
    expect_affine(image, kRasFromLps);
  }
}

// Such files come from programs that change the stream but not the header. In some cases more data follow the
// stream.
TEST_F(ReadImage, MetaImageWithAStreamThatIsNotAsLongAsItsHeaderSays) {
  const std::string zipped = deflated(kVoxels, 15), size = std::to_string(zipped.size());
  const auto read = [&](const std::string& announced, const std::string& tail) {
    return read_image(folder_.write("a.mha", mha_header("CompressedData = True\nCompressedDataSize = " +
                                                        announced + "\n" + kMhaFields + kMhaLocal) +
                                                 zipped + tail));
  };
  for (const std::string& announced : {std::string("1"), std::string("123456"), size}) {
    for (const std::string& tail : {std::string(), std::string("more")}) {
      const LabelImage image = read(announced, tail);
      expect_two_voxels(image);
      expect_affine(image, kRasFromLps);
      ASSERT_EQ(image.warnings.size(), announced == size ? 0u : 1u);
      if (announced == size) continue;
      EXPECT_NE(image.warnings[0].find("a.mha: "), std::string::npos) << image.warnings[0];
      EXPECT_NE(image.warnings[0].find(announced), std::string::npos) << image.warnings[0];
      EXPECT_NE(image.warnings[0].find(size), std::string::npos) << image.warnings[0];
    }
  }
}

TEST_F(ReadImage, CompressedMetaImageOfTheOtherByteOrder) {
  std::vector<std::uint16_t> voxels;
  for (const std::uint8_t v : two_voxels()) voxels.push_back(static_cast<std::uint16_t>(v << 8));
  std::string header = mha_header("CompressedData = True\n" + kMhaFields + kMhaLocal);
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"MSB = False", "MSB = True"},
                                 std::pair<std::string, std::string>{"UCHAR", "USHORT"}})
    header.replace(header.find(from), from.size(), to);
  expect_two_voxels(read_image(folder_.write("a.mha", header + deflated(bytes_of_values(voxels), 15))));
}

TEST_F(ReadImage, MetaImageWithItsVoxelsBeside) {
  folder_.write("a.raw", kVoxels);
  const LabelImage image =
      read_image(folder_.write("a.mhd", mha_header(kMhaFields + "ElementDataFile = a.raw\n")));
  expect_two_voxels(image);
  expect_affine(image, kRasFromLps);
}

TEST_F(ReadImage, Inr) {
  const std::string file = inr_header("VX=1\nVY=2\nVZ=3\nTX=-4\n") + kVoxels;
  for (const auto& [name, bytes] : {std::pair{"a.inr", file}, std::pair{"a.inr.gz", deflated(file)}}) {
    const LabelImage image = read_image(folder_.write(name, bytes));
    expect_two_voxels(image);
    expect_affine(image, {1, 0, 0, -4, 0, 2, 0, 0, 0, 0, 3, 0});
  }
}

template <class T>
std::vector<T> two_voxels_as() {
  const auto voxels = two_voxels();
  return {voxels.begin(), voxels.end()};
}

TEST_F(ReadImage, EveryIntegerTypeAndIntegralFloats) {
  const auto read = [&](short datatype, short bits, const std::string& voxels) {
    nifti_1_header header = nifti_header();
    header.datatype = datatype;
    header.bitpix = bits;
    return read_image(folder_.write("a.nii", nifti_file(header, voxels)));
  };
  expect_two_voxels(read(DT_INT8, 8, bytes_of_values(two_voxels_as<std::int8_t>())));
  expect_two_voxels(read(DT_UINT16, 16, bytes_of_values(two_voxels_as<std::uint16_t>())));
  expect_two_voxels(read(DT_INT16, 16, bytes_of_values(two_voxels_as<std::int16_t>())));
  expect_two_voxels(read(DT_UINT32, 32, bytes_of_values(two_voxels_as<std::uint32_t>())));
  expect_two_voxels(read(DT_INT32, 32, bytes_of_values(two_voxels_as<std::int32_t>())));
  expect_two_voxels(read(DT_FLOAT32, 32, bytes_of_values(two_voxels_as<float>())));
  expect_two_voxels(read(DT_FLOAT64, 64, bytes_of_values(two_voxels_as<double>())));
}

template <class Voxel>
std::string in_nifti(short datatype, const std::vector<Voxel>& voxels) {
  nifti_1_header header = nifti_header();
  header.datatype = datatype;
  header.bitpix = 8 * sizeof(Voxel);
  return nifti_file(header, bytes_of_values(voxels));
}

// nibabel and SimpleITK write such files. MetaIO calls eight bytes MET_LONG_LONG, and four MET_LONG.
TEST_F(ReadImage, IntegersOf64Bits) {
  auto voxels = two_voxels_as<std::int64_t>();
  const std::string of_int64 = bytes_of_values(voxels);
  const std::vector<std::uint64_t> without_sign(voxels.begin(), voxels.end());
  expect_two_voxels(read_image(folder_.write("a.nii", in_nifti(DT_INT64, voxels))));
  expect_two_voxels(read_image(folder_.write("b.nii", in_nifti(DT_UINT64, without_sign))));
  for (const char* type : {"int64", "uint64", "long long", "unsigned long long int"}) {
    const std::string header = nrrd_header(replaced(kNrrdFields, "uchar", type) + "encoding: raw\n");
    expect_two_voxels(read_image(folder_.write("a.nrrd", header + of_int64)));
  }
  for (const char* type : {"MET_LONG_LONG", "MET_ULONG_LONG"}) {
    const std::string header = mha_header(replaced(kMhaFields, "MET_UCHAR", type) + kMhaLocal);
    expect_two_voxels(read_image(folder_.write("a.mha", header + of_int64)));
  }
  const std::string header = mha_header(replaced(kMhaFields, "MET_UCHAR", "MET_LONG") + kMhaLocal);
  expect_two_voxels(
      read_image(folder_.write("b.mha", header + bytes_of_values(two_voxels_as<std::int32_t>()))));
}

TEST_F(ReadImage, LabelsOf64BitsEndWhereLabelsDo) {
  auto voxels = two_voxels_as<std::int64_t>();
  voxels[2] = 0xffffffffLL;
  const LabelImage image = read_image(folder_.write("a.nii", in_nifti(DT_INT64, voxels)));
  EXPECT_EQ(image.labels.back().value, 0xffffffffU);
  for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{1} << 32, std::int64_t{1} << 62}) {
    voxels[2] = value;
    const std::string path = folder_.write("b.nii", in_nifti(DT_INT64, voxels));
    try {
      read_image(path);
      ADD_FAILURE() << value;
    } catch (const InputError& error) {
      const std::string expected = "voxel (0, 1, 0) is " + std::to_string(value) + ", no label";
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  }
}

TEST_F(ReadImage, TheLargestValue) {
  nifti_1_header header = nifti_header();
  header.datatype = DT_UINT32;
  header.bitpix = 32;
  std::vector<std::uint32_t> voxels(24, 0xffffffffU);
  voxels[0] = 0;
  const LabelImage image = read_image(folder_.write("a.nii", nifti_file(header, bytes_of_values(voxels))));
  ASSERT_EQ(image.labels.size(), 2u);
  EXPECT_EQ(image.labels[1].value, 0xffffffffU);
}

}  // namespace
}  // namespace podm
