// Bad input: each fault is refused with a message "FILE: fault" that names it.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include "image/tests/image_files.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

struct BadFile {
  const char* fault;
  const char* name;
  std::function<std::string()> bytes;
  const char* message;  // a part of the message
};

std::string changed_nifti(const std::function<void(nifti_1_header&)>& change,
                          const std::string& voxels = kVoxels) {
  nifti_1_header header = nifti_header();
  change(header);
  return nifti_file(header, voxels);
}

template <class T>
std::string nifti_of(short datatype, std::vector<T> voxels) {
  return changed_nifti(
      [&](nifti_1_header& h) {
        h.datatype = datatype;
        h.bitpix = 8 * sizeof(T);
      },
      bytes_of_values(voxels));
}

// 24 voxels: the last is `value`, all others are 1.
template <class T>
std::vector<T> with_last(T value) {
  std::vector<T> voxels(24, 1);
  voxels.back() = value;
  return voxels;
}

std::string cut(const std::string& bytes, std::size_t less) { return bytes.substr(0, bytes.size() - less); }

std::string compressed_mha(const std::string& stream) {
  return mha_header("CompressedData = True\nCompressedDataSize = " + std::to_string(stream.size()) + "\n" +
                    kMhaFields + kMhaLocal) +
         stream;
}

// Voxels that do not compress. A cut stream therefore loses some of them.
std::string noise(std::size_t bytes) {
  std::string text(bytes, '\0');
  std::uint32_t state = 1;
  for (char& c : text) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  return text;
}

class Refused : public testing::TestWithParam<BadFile> {};

TEST_P(Refused, NamingFileAndFault) {
  const ScratchFolder folder;
  const BadFile& bad = GetParam();
  const std::string path = folder.write(bad.name, bad.bytes());
  try {
    read_image(path);
    FAIL() << "was read";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.substr(0, path.size() + 2), path + ": ");
    EXPECT_NE(text.find(bad.message), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

const std::string kNrrdRaw = nrrd_header(kNrrdFields + "encoding: raw\n");
const std::string kNrrdGzip = nrrd_header(kNrrdFields + "encoding: gzip\n");
const std::string kMha = mha_header(kMhaFields + kMhaLocal);
const std::string kInr = inr_header("VX=1\nVY=2\nVZ=3\n");

std::vector<BadFile> bad_nifti_files() {
  return {
      {"Empty", "a.nii", [] { return std::string(); }, "empty"},
      {"WrongMagic", "a.nii", [] { return std::string(1000, 'x'); }, "magic"},
      {"TruncatedHeader", "a.nii", [] { return nifti_file(nifti_header(), kVoxels).substr(0, 100); }, ""},
      {"TruncatedVoxels", "a.nii", [] { return nifti_file(nifti_header(), cut(kVoxels, 1)); }, "truncated"},
      {"TruncatedZippedVoxels", "a.nii.gz",
       [] { return deflated(nifti_file(nifti_header(), cut(kVoxels, 1))); }, "truncated"},
      {"TruncatedGzip", "a.nii.gz", [] { return cut(deflated(nifti_file(nifti_header(), kVoxels)), 12); },
       "truncated"},
      {"DamagedGzip", "a.nii.gz",
       [] {
         std::string file = deflated(nifti_file(nifti_header(), kVoxels));
         file[file.size() - 6] ^= 1;  // in the checksum
         return file;
       },
       "damaged"},
      {"TwoDimensions", "a.nii",
       [] {
         return changed_nifti(
             [](auto& h) {
               h.dim[0] = 2;
               h.dim[3] = 1;
             },
             cut(kVoxels, 18));
       },
       "3-D"},
      {"FourDimensions", "a.nii",
       [] {
         return changed_nifti(
             [](auto& h) {
               h.dim[0] = 4;
               h.dim[4] = 2;
             },
             kVoxels + kVoxels);
       },
       "3-D"},
      {"Colour", "a.nii",
       [] {
         return changed_nifti(
             [](auto& h) {
               h.datatype = DT_RGB24;
               h.bitpix = 24;
             },
             kVoxels + kVoxels + kVoxels);
       },
       "one"},
      {"ZeroSpacing", "a.nii",
       [] {
         return changed_nifti([](auto& h) {
           h.srow_x[0] = 0;
           h.pixdim[1] = 0;
         });
       },
       ""},
      {"NanSpacing", "a.nii", [] { return changed_nifti([](auto& h) { h.srow_x[0] = std::nanf(""); }); }, ""},
      {"SingularAffine", "a.nii",
       [] {
         return changed_nifti([](auto& h) {
           h.srow_y[1] = 0;
           h.srow_x[1] = 2;
         });
       },
       "singular"},
      {"ShearedAndTruncated", "a.nii",
       [] { return changed_nifti([](auto& h) { h.srow_x[1] = 0.5F; }, cut(kVoxels, 1)); }, "truncated"},
      {"ShearedAndHuge", "a.nii",
       [] {
         return changed_nifti([](auto& h) {
           h.srow_x[1] = 0.5F;
           h.dim[1] = h.dim[2] = h.dim[3] = 1290;
         });
       },
       "truncated"},
      {"HugeDimensions", "a.nii",
       [] { return changed_nifti([](auto& h) { h.dim[1] = h.dim[2] = h.dim[3] = 1290; }); }, "truncated"},
      {"HugeZippedDimensions", "a.nii.gz",
       [] { return deflated(changed_nifti([](auto& h) { h.dim[1] = h.dim[2] = h.dim[3] = 1290; })); },
       "truncated"},
      {"TooManyVoxels", "a.nii",
       [] {
         return changed_nifti([](auto& h) {
           h.dim[1] = 2048;
           h.dim[2] = h.dim[3] = 1024;  // 2^31
         });
       },
       "too large (2048 x 1024 x 1024 voxels, at most 2147483647 in all are supported)"},
      {"VoxelsPastTheEnd", "a.nii", [] { return changed_nifti([](auto& h) { h.vox_offset = 360; }); },
       "truncated"},
      {"NoForeground", "a.nii", [] { return nifti_file(nifti_header(), std::string(24, '\0')); },
       "foreground"},
      {"Negative", "a.nii", [] { return nifti_of<std::int16_t>(DT_INT16, with_last<std::int16_t>(-3)); },
       "voxel (1, 2, 3) is -3, no label"},
      {"Fraction", "a.nii", [] { return nifti_of<float>(DT_FLOAT32, std::vector<float>(24, 1.5F)); },
       "voxel (0, 0, 0) is 1.5"},
      {"NotANumber", "a.nii", [] { return nifti_of<float>(DT_FLOAT32, with_last(std::nanf(""))); },
       "voxel (1, 2, 3) is nan, no label"},
      {"PastTheLargestValue", "a.nii", [] { return nifti_of<double>(DT_FLOAT64, with_last(4294967296.0)); },
       "voxel (1, 2, 3) is 4294967296"},
      {"TooManyLabels", "a.nii",
       [] {
         std::vector<std::uint32_t> voxels(41 * 41 * 41);
         for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<std::uint32_t>(i);
         return changed_nifti(
             [](auto& h) {
               h.dim[1] = h.dim[2] = h.dim[3] = 41;
               h.datatype = DT_UINT32;
               h.bitpix = 32;
             },
             bytes_of_values(voxels));
       },
       "65535 different values"},
      {"UnknownFormat", "a.png", [] { return std::string("x"); }, "format"},
  };
}

std::vector<BadFile> bad_other_files() {
  return {
      {"NrrdWrongMagic", "a.nrrd", [] { return replaced(kNrrdRaw, "NRRD", "NORD") + kVoxels; }, "magic"},
      {"NrrdTruncated", "a.nrrd", [] { return kNrrdRaw + cut(kVoxels, 1); }, "truncated"},
      {"NrrdTruncatedGzip", "a.nrrd", [] { return kNrrdGzip + cut(deflated(kVoxels), 10); }, "truncated"},
      {"NrrdShortGzip", "a.nrrd", [] { return kNrrdGzip + deflated(cut(kVoxels, 1)); }, "truncated"},
      {"NrrdHuge", "a.nrrd", [] { return replaced(kNrrdRaw, "2 3 4", "2000000 2000000 2000000") + kVoxels; },
       "too large"},
      {"NrrdTooMany", "a.nrrd", [] { return replaced(kNrrdRaw, "2 3 4", "20000 20000 5") + kVoxels; },
       "truncated"},
      {"NrrdTooManyBeside", "a.nhdr",
       [] {
         return nrrd_header(replaced(kNrrdFields, "2 3 4", "20000 20000 5") +
                            "encoding: raw\ndata file: a.nhdr\n");
       },
       "truncated"},
      {"NrrdVoxelsMissing", "a.nhdr",
       [] { return nrrd_header(kNrrdFields + "encoding: raw\ndata file: missing.raw\n"); }, "missing.raw"},
      {"NrrdTwoDimensions", "a.nrrd",
       [] { return nrrd_header("type: uchar\ndimension: 2\nsizes: 4 6\nencoding: raw\n") + kVoxels; }, "3-D"},
      {"NrrdNanSpacing", "a.nrrd", [] { return replaced(kNrrdRaw, "(0,2,0)", "(0,nan,0)") + kVoxels; }, ""},
      {"MhaWrongMagic", "a.mha", [] { return std::string(1000, 'x'); }, "magic"},
      {"NrrdLongLine", "a.nrrd",
       [] {
         return nrrd_header(kNrrdFields + "content: " + std::string(500, 'c') + "\nencoding: raw\n") +
                kVoxels;
       },
       "line 9 of the NRRD header is longer"},
      {"NrrdLongMagic", "a.nrrd",
       [] { return "NRRD0004" + std::string(500, ' ') + ":=" + kNrrdRaw + kVoxels; },
       "line 1 of the NRRD header is longer"},
      {"MhaLongName", "a.mha", [] { return std::string(255, 'n') + " = 1\n" + kMha + kVoxels; }, "line 1 "},
      {"MhaLongComment", "a.mha",
       [] {
         return mha_header("Comment = " + std::string(255, 'c') + "\n" + kMhaFields + kMhaLocal) + kVoxels;
       },
       "longer than 254 bytes"},
      {"MhaNameAlone", "a.mha",
       [] { return replaced(kMha, "ElementDataFile", "Comment\nElementDataFile") + kVoxels; },
       "name = value"},
      {"MhaNameWithColon", "a.mha", [] { return replaced(kMha, "DimSize =", "DimSize: =") + kVoxels; },
       "name = value"},
      {"MhaLastInLowerCase", "a.mha",
       [] { return replaced(kMha, "ElementDataFile", "elementdatafile") + kVoxels; }, "name = value"},
      {"MhaTruncated", "a.mha", [] { return kMha + cut(kVoxels, 1); }, "truncated"},
      {"MhaTruncatedZlib", "a.mha", [] { return compressed_mha(cut(deflated(kVoxels, 15), 5)); },
       "truncated"},
      {"MhaCutZlibThatAnnouncesMore", "a.mha",
       [] {
         const std::string file = compressed_mha(deflated(noise(24), 15));
         return cut(file, 8);
       },
       "truncated"},
      {"MhaDamagedZlib", "a.mha",
       [] {
         std::string file = compressed_mha(deflated(kVoxels, 15));
         file.back() ^= 1;  // in the checksum
         return file;
       },
       "damaged"},
      {"MhaLongZlib", "a.mha", [] { return compressed_mha(deflated(kVoxels + "x", 15)); }, "more data"},
      {"MhaHugeZlib", "a.mha",
       [] { return replaced(compressed_mha(deflated(kVoxels, 15)), "2 3 4", "1200 1200 1200"); },
       "truncated"},
      {"MhaUnknownLocal", "a.mha",
       [] { return mha_header(kMhaFields) + "ElementDataFile = LOCaL\n" + kVoxels; }, "LOCaL"},
      {"MhaReturnInAValue", "a.mha",
       [] { return mha_header(kMhaFields) + "ElementDataFile = \r\r LOCAL\n" + kVoxels; }, "carriage return"},
      {"MhaNoSize", "a.mha", [] { return replaced(kMha, "DimSize = 2 3 4\n", "") + kVoxels; }, "dimsize"},
      {"MhaShortZlib", "a.mha", [] { return compressed_mha(deflated(cut(kVoxels, 1), 15)); }, "truncated"},
      {"MhaHuge", "a.mha", [] { return replaced(kMha, "2 3 4", "1200 1200 1200") + kVoxels; }, "truncated"},
      {"MhaTooManyBeside", "a.mhd",
       [] {
         return replaced(mha_header(kMhaFields), "2 3 4", "20000 20000 5") + "ElementDataFile = a.mhd\n";
       },
       "truncated"},
      {"MhaVoxelsMissing", "a.mhd", [] { return mha_header(kMhaFields) + "ElementDataFile = missing.raw\n"; },
       "missing.raw"},
      {"MhaVector", "a.mha",
       [] {
         return mha_header("ElementNumberOfChannels = 3\n" + kMhaFields + kMhaLocal) + kVoxels + kVoxels +
                kVoxels;
       },
       "one value"},
      {"MhaZeroSpacing", "a.mha",
       [] { return replaced(kMha, "ElementSpacing = 1 2 3", "ElementSpacing = 1 0 3") + kVoxels; },
       "spacing"},
      {"MhaSingular", "a.mha",
       [] { return replaced(kMha, "1 0 0 0 1 0 0 0 1", "1 0 0 1 0 0 0 0 1") + kVoxels; }, "singular"},
      {"MhaTinyVoxels", "a.mha",
       [] { return replaced(kMha, "ElementSpacing = 1 2 3", "ElementSpacing = 1 2e-31 3") + kVoxels; },
       "spacing"},
      {"MhaHugeVoxels", "a.mha",
       [] { return replaced(kMha, "ElementSpacing = 1 2 3", "ElementSpacing = 1 2e31 3") + kVoxels; },
       "spacing"},
      {"MhaFarAway", "a.mha",
       [] { return replaced(kMha, "Offset = 10 20 30", "Offset = 10 -1.8e10 30") + kVoxels; }, "origin"},
      {"InrWrongMagic", "a.inr", [] { return std::string(1000, 'x'); }, "magic"},
      {"InrTruncated", "a.inr", [] { return kInr + cut(kVoxels, 1); }, "truncated"},
      {"InrTruncatedGzip", "a.inr.gz", [] { return cut(deflated(kInr + noise(24)), 12); }, "truncated"},
      {"InrHuge", "a.inr",
       [] { return inr_header("", "XDIM=2000000\nYDIM=2000000\nZDIM=2000000\nVDIM=1\n") + kVoxels; },
       "too large"},
      {"InrOfTheMostVoxels", "a.inr",
       [] { return inr_header("", "XDIM=2147483647\nYDIM=1\nZDIM=1\nVDIM=1\n") + kVoxels; }, "truncated"},
      {"InrNegativeSize", "a.inr",
       [] { return inr_header("", "XDIM=-2\nYDIM=3\nZDIM=4\nVDIM=1\n") + kVoxels; }, "no voxels"},
      {"InrVector", "a.inr",
       [] { return inr_header("", "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=3\n") + kVoxels + kVoxels + kVoxels; },
       "VDIM"},
      {"InrZeroSpacing", "a.inr", [] { return inr_header("VX=0\nVY=2\nVZ=3\n") + kVoxels; }, "VX"},
      {"InrNoEnd", "a.inr", [] { return replaced(kInr, "##}", "   ") + kVoxels; }, "end"},
      {"InrUnknownType", "a.inr",
       [] {
         return inr_header("", "XDIM=2\nYDIM=3\nZDIM=4\n", "TYPE=packed\nPIXSIZE=8 bits\nCPU=decm\n") +
                kVoxels;
       },
       "type"},
  };
}

std::string fault_name(const testing::TestParamInfo<BadFile>& param_info) { return param_info.param.fault; }

INSTANTIATE_TEST_SUITE_P(Nifti, Refused, testing::ValuesIn(bad_nifti_files()), fault_name);
INSTANTIATE_TEST_SUITE_P(Other, Refused, testing::ValuesIn(bad_other_files()), fault_name);

TEST(ReadImageRefused, MissingFileAndFolder) {
  const ScratchFolder folder;
  const std::string in_folder = folder.write("x", "x");
  for (const std::string& path :
       {in_folder + "missing.nii.gz", in_folder + "missing.inr", in_folder + "missing.mha"})
    EXPECT_THROW(read_image(path), InputError) << path;
  EXPECT_THROW(read_image("/"), InputError);
}

// ITK quotes the path in a message of limited length.
TEST(ReadImageRefused, NrrdUnderALongPath) {
  const ScratchFolder folder;
  const std::string name = std::string(200, 'd'), inner = name + "/" + name + "/" + name + "/";
  std::filesystem::create_directories(folder.write(inner, ""));
  EXPECT_THROW(read_image(folder.write(inner + "a.nrrd", "NRRD0004\nno field\n\n")), InputError);
}

// Values that never compare equal would all be inserted into a set, and each look-up would search all of
// them.
TEST(ReadImageRefused, AnImageOfNothingButNansAtOnce) {
  const ScratchFolder folder;
  const auto nans = std::vector<float>(std::size_t{64} * 64 * 64, std::nanf(""));
  nifti_1_header header = nifti_header();
  header.dim[1] = header.dim[2] = header.dim[3] = 64;
  header.datatype = DT_FLOAT32;
  header.bitpix = 32;
  const std::string path = folder.write("nan.nii", nifti_file(header, bytes_of_values(nans)));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(read_image(path), InputError);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(4));  // it took 20 s before
}

TEST(ReadImageRefused, PhantomsThatAreNone) {
  for (const char* name :
       {"phantom:", "phantom:nothing", "phantom:torus@", "phantom:torus@x", "phantom:torus@-5"})
    EXPECT_THROW(read_image(name), InputError) << name;
}

}  // namespace
}  // namespace podm
