// A bad image file is refused in one line that names it and the fault.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "errors.h"
#include "image/image.h"
#include "made_files.h"

namespace podm::verify {
namespace {

struct BadFile {
  const char* fault;
  const char* name;
  std::function<std::string()> bytes;
  const char* message;  // a part of the message
};

template <class Change>
std::function<std::string()> nifti_with(Change change, const std::string& voxels = kVoxels) {
  return [=] { return nifti_file(voxels, change); };
}
std::function<std::string()> text(const std::string& bytes) {
  return [=] { return bytes; };
}
std::string cut(const std::string& bytes, std::size_t by) { return bytes.substr(0, bytes.size() - by); }

template <class T>
std::function<std::string()> filled_nifti(short datatype, T value) {
  return nifti_with([=](auto& h) { h.datatype = datatype; }, bytes_of_values(std::vector<T>(24, value)));
}

class RefuseVerifierImage : public testing::TestWithParam<BadFile> {};

TEST_P(RefuseVerifierImage, NamingFileAndFault) {
  const Folder folder;
  const BadFile& bad = GetParam();
  const std::string path = folder.write(bad.name, bad.bytes());
  try {
    read_image(path);
    FAIL() << "was read";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(path + ": ")) << message;
    EXPECT_NE(message.find(bad.message), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

const std::string kRawNrrd = kNrrdHeader + "encoding: raw\n\n",
                  kGzipNrrd = kNrrdHeader + "encoding: gzip\n\n";
const std::string kMeta = kMetaHeader + "ElementDataFile = LOCAL\n";
const std::string kZippedMeta = "CompressedData = True\n" + kMeta;
const auto kHuge = [](auto& h) { h.dim[1] = h.dim[2] = h.dim[3] = 32767; };

std::vector<BadFile> bad_files() {
  std::string damaged = deflated(nifti_file(kVoxels));
  damaged[damaged.size() - 6] ^= 1;  // in the checksum
  return {
      {"Empty", "a.nii", text(""), "empty"},
      {"UnknownFormat", "a.png", text("x"), "format"},
      {"NiftiMagic", "a.nii", text(std::string(1000, 'x')), "magic"},
      {"NiftiHeader", "a.nii", text(nifti_file(kVoxels).substr(0, 100)), "truncated"},
      {"NiftiVoxels", "a.nii", text(nifti_file(cut(kVoxels, 1))), "truncated"},
      {"NiftiTooLong", "a.nii", text(nifti_file(kVoxels + "x")), "more data"},
      {"GzipVoxels", "a.nii.gz", text(deflated(nifti_file(cut(kVoxels, 1)))), "truncated"},
      {"GzipEnd", "a.nii.gz", text(cut(deflated(nifti_file(kVoxels)), 6)), "truncated"},
      {"GzipDamaged", "a.nii.gz", text(damaged), "damaged"},
      {"TwoDimensions", "a.nii", nifti_with([](auto& h) { h.dim[0] = 2; }), "3-D"},
      {"FourDimensions", "a.nii",
       nifti_with(
           [](auto& h) {
             h.dim[0] = 4;
             h.dim[4] = 2;
           },
           kVoxels + kVoxels),
       "3-D"},
      {"NegativeDimension", "a.nii", nifti_with([](auto& h) { h.dim[2] = -3; }), "no voxels"},
      {"Colour", "a.nii", nifti_with([](auto& h) { h.datatype = DT_RGB24; }, kVoxels + kVoxels + kVoxels),
       "one plain number"},
      {"Scaled", "a.nii", nifti_with([](auto& h) { h.scl_slope = 2; }), "scales"},
      {"NanAffine", "a.nii", nifti_with([](auto& h) { h.srow_x[0] = std::nanf(""); }), "spacing"},
      {"NanOffset", "a.nii", nifti_with([](auto& h) { h.srow_x[3] = std::nanf(""); }), "finite"},
      {"ZeroSpacing", "a.nii", nifti_with([](auto& h) { h.srow_x[0] = 0; }), "spacing"},
      {"Singular", "a.nii", nifti_with([](auto& h) {
         h.srow_y[1] = 0;
         h.srow_x[1] = 2;
       }),
       "singular"},
      {"HugeNifti", "a.nii", nifti_with(kHuge), "truncated"},
      {"HugeGzip", "a.nii.gz", [] { return deflated(nifti_file(kVoxels, kHuge)); }, "truncated"},
      {"Negative", "a.nii", filled_nifti<std::int16_t>(DT_INT16, -3), "label"},
      {"Fraction", "a.nii", filled_nifti(DT_FLOAT32, 1.5F), "label"},
      {"NotANumber", "a.nii", filled_nifti(DT_FLOAT32, std::nanf("")), "label"},
      {"TooLarge", "a.nii", filled_nifti(DT_FLOAT64, 4294967296.0), "label"},
      {"NrrdMagic", "a.nrrd", text(replaced(kRawNrrd, "NRRD", "NORD") + kVoxels), "magic"},
      {"NrrdVoxels", "a.nrrd", text(kRawNrrd + cut(kVoxels, 1)), "truncated"},
      {"NrrdShortGzip", "a.nrrd", text(kGzipNrrd + deflated(cut(kVoxels, 1))), "truncated"},
      {"NrrdCutGzip", "a.nrrd", text(kGzipNrrd + cut(deflated(kVoxels), 10)), "truncated"},
      {"NrrdHuge", "a.nrrd", text(replaced(kRawNrrd, "2 3 4", "20000 20000 200") + kVoxels), "truncated"},
      {"NrrdMissing", "a.nhdr", text(kNrrdHeader + "encoding: raw\ndata file: no.raw\n\n"), "no.raw"},
      {"NrrdText", "a.nrrd", text(kNrrdHeader + "encoding: ascii\n\n1 2 3"), "encoding"},
      {"NrrdFlat", "a.nrrd",
       text("NRRD0004\ntype: uchar\ndimension: 2\nsizes: 4 6\nencoding: raw\n\n" + kVoxels), "3-D"},
      {"NrrdNan", "a.nrrd", text(replaced(kRawNrrd, "(0,2,0)", "(0,nan,0)") + kVoxels), ""},
      {"MetaMagic", "a.mha", text(std::string(1000, 'x')), "magic"},
      {"NrrdLongLine", "a.nrrd",
       text(replaced(kRawNrrd, "encoding", "content: " + std::string(500, 'c') + "\nencoding") + kVoxels),
       "more than 500 bytes"},
      {"MetaLongName", "a.mha", text(std::string(255, 'n') + " = 1\n" + kMeta + kVoxels), "line 1 "},
      {"MetaLongComment", "a.mha", text("Comment = " + std::string(255, 'c') + "\n" + kMeta + kVoxels),
       "255 bytes"},
      {"MetaNameAlone", "a.mha",
       text(replaced(kMeta, "ElementDataFile", "Comment\nElementDataFile") + kVoxels), "name = value"},
      {"MetaLastInLowerCase", "a.mha", text(replaced(kMeta, "ElementDataFile", "elementdatafile") + kVoxels),
       "name = value"},
      {"MetaVoxels", "a.mha", text(kMeta + cut(kVoxels, 1)), "truncated"},
      {"MetaShortZlib", "a.mha", text(kZippedMeta + deflated(cut(kVoxels, 1), 15)), "truncated"},
      {"MetaCutZlib", "a.mha", text(kZippedMeta + cut(deflated(kVoxels, 15), 5)), "truncated"},
      {"MetaCutZlibThatAnnouncesMore", "a.mha",
       text("CompressedDataSize = 999\n" + kZippedMeta + cut(deflated(kVoxels, 15), 5)), "truncated"},
      {"MetaDamagedZlib", "a.mha",
       [] {
         std::string file = kZippedMeta + deflated(kVoxels, 15);
         file.back() ^= 1;  // in the checksum
         return file;
       },
       "damaged"},
      {"MetaNoSize", "a.mha", text(replaced(kMeta, "DimSize = 2 3 4\n", "") + kVoxels), "dimsize"},
      {"MetaHuge", "a.mha", text(replaced(kMeta, "2 3 4", "2000 2000 2000") + kVoxels), "truncated"},
      {"MetaMissing", "a.mhd", text(kMetaHeader + "ElementDataFile = no.raw\n"), "no.raw"},
      {"MetaVector", "a.mha", text("ElementNumberOfChannels = 3\n" + kMeta + kVoxels + kVoxels + kVoxels),
       "one value"},
      {"InrMagic", "a.inr", text(std::string(1000, 'x')), "magic"},
      {"InrVoxels", "a.inr", text(inr_header("") + cut(kVoxels, 1)), "truncated"},
      {"InrHuge", "a.inr", text(inr_header("XDIM=2000000\nYDIM=2000000\nZDIM=2000000\n") + kVoxels), "large"},
      {"InrNegative", "a.inr", text(inr_header("XDIM=-2\n") + kVoxels), "no voxels"},
      {"InrVector", "a.inr", text(inr_header("VDIM=3\n") + kVoxels), "VDIM"},
      {"InrZeroSpacing", "a.inr", text(inr_header("VX=0\n") + kVoxels), "VX"},
      {"InrNoEnd", "a.inr", text(replaced(inr_header(""), "##}", "   ") + std::string(70000, ' ')), "end"},
      {"InrType", "a.inr", text(inr_header("TYPE=packed\n") + kVoxels), "type"},
      {"InrCpu", "a.inr", text(inr_header("CPU=pdp11\n") + kVoxels), "CPU"},
  };
}

INSTANTIATE_TEST_SUITE_P(All, RefuseVerifierImage, testing::ValuesIn(bad_files()),
                         [](const auto& param_info) { return param_info.param.fault; });

TEST(RefuseVerifierImage, AnEmptyFileOfVoxelsIsAFaultOfTheImage) {
  const Folder folder;
  folder.write("a.raw", "");
  const std::string path = folder.write("a.mhd", kMetaHeader + "ElementDataFile = a.raw\n");
  try {
    read_image(path);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path + ": '")) << error.what();
  }
}

TEST(RefuseVerifierImage, MissingFileAndFolder) {
  const Folder folder;
  EXPECT_THROW(read_image("no/such/file.nii"), InputError);
  EXPECT_THROW(read_image(std::filesystem::temp_directory_path().string() + "/.nii"), InputError);
}

}  // namespace
}  // namespace podm::verify
