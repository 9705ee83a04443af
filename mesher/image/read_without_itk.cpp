// The reader of NRRD and MetaImage in a build without ITK (PODM_ITK): it refuses each file.
#include "image/read_formats.h"

namespace podm {

RawImage read_with_itk(const std::string& path, std::uint64_t) {
  refuse(path, "this program was built without ITK, which reads NRRD and MetaImage; it reads NIfTI and INR");
}

}  // namespace podm
