// The readers of NRRD and MetaImage in a build without ITK (PODM_ITK): they refuse each file.
#include "image/raw_image.h"

namespace podm::verify {

namespace {

[[noreturn]] void refuse_format(const std::string& path) {
  refuse(path, "this program was built without ITK, which reads NRRD and MetaImage; it reads NIfTI and INR");
}

}  // namespace

RawImage read_nrrd(const std::string& path) { refuse_format(path); }

RawImage read_meta(const std::string& path) { refuse_format(path); }

}  // namespace podm::verify
