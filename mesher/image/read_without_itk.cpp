// The reader of NRRD and MetaImage in a build without ITK (PODM_ITK): it refuses each file.
#include "image/read_formats.h"

namespace podm {

ImageHead read_head_with_itk(const std::string& path) {
  refuse(path, "this program was built without ITK, which reads NRRD and MetaImage; it reads NIfTI and INR");
}

RawImage read_with_itk(const std::string& path, std::uint64_t) { return read_head_with_itk(path).image; }

}  // namespace podm
