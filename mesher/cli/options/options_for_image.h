// The options of the library, derived from the command line, the image and the memory of the machine.
#pragma once

#include <cstdint>

#include "cli/options/options.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

/// Returns the bytes that the process may use: the limit given, otherwise kPercentOfAvailableMemory of the
/// memory that is available now, before the image is read.
std::uint64_t memory_limit_bytes(const MeshCommand& command);
/// Returns the part of the limit that the image may take during reading.
std::uint64_t bytes_for_image(std::uint64_t limit_bytes);

/// Returns the options as given, with labels by value, and the size image read within the limit. Throws
/// InputError that names the image and the fault if a label is absent or delta exceeds the image.
MeshingOptions options_as_given(const MeshCommand& command, const LabelImage& image,
                                std::uint64_t limit_bytes);
/// Returns the options as given, with limits for the available memory. Throws InputError that names the image
/// and the fault if a label is absent, if delta exceeds the image, or if the run is expected to need more
/// memory than allowed. The mesh is distributed over `num_ranks` processes; each holds the image.
MeshingOptions options_for_image(const MeshCommand& command, const LabelImage& image,
                                 std::uint64_t limit_bytes, int num_ranks = 1);

}  // namespace podm::cli
