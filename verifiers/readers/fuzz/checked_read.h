// The check that the fuzz targets of all formats share.
#pragma once

#include "fuzz_scratch.h"

namespace podm::verify {

/// Aborts unless one of two things holds. Either the file `path` is a mesh that keeps the guarantees of Mesh
/// and is no larger than `num_bytes` (inflated) can describe; or it is refused with an InputError that begins
/// with the file's folder and name without the extension, as a format may consist of several files.
void read_checked(const std::string& path, std::size_t num_bytes);

}  // namespace podm::verify
