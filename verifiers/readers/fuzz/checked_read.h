// What the fuzz targets of all formats do with their bytes.
#pragma once

#include "fuzz_scratch.h"

namespace podm::verify {

/// The file `path` either is a mesh that keeps what Mesh promises, and no larger than `num_bytes` (inflated)
/// can tell, or is refused with an InputError that begins with the file's folder and name, but for its
/// extension: a format may be of several files. Anything else aborts.
void read_checked(const std::string& path, std::size_t num_bytes);

}  // namespace podm::verify
