// The options of the library, from those of the command line, the image and the memory of the machine.
#pragma once

#include <cstdint>

#include "cli/options/options.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

/// What the process may take: as asked for, else that share of what is available now, before the image is
/// read.
std::uint64_t memory_limit_bytes(const MeshCommand& command);
/// What of it the image may take while it is read.
std::uint64_t bytes_for_image(std::uint64_t limit_bytes);

/// The options as they were given, with labels by their values, and the size image read within the limit.
/// Throws InputError, naming the image and the fault, where a label is absent or delta exceeds the image.
MeshingOptions options_as_given(const MeshCommand& command, const LabelImage& image,
                                std::uint64_t limit_bytes);
/// The same within the memory that there is. Throws InputError, naming the image and the fault, where a label
/// is absent, delta exceeds the image, or the run is expected to need more memory than allowed. The mesh is
/// in as many processes as there are ranks, the image in each.
MeshingOptions options_for_image(const MeshCommand& command, const LabelImage& image,
                                 std::uint64_t limit_bytes, int num_ranks = 1);

}  // namespace podm::cli
