#include "cli/options/options_for_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/memory_model.h"
#include "algorithms/team_size.h"
#include "cli/commands/labelled_image.h"
#include "cli/processes/process_memory.h"
#include "distributed/memory_of_ranks.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "prediction/cost_model.h"
#include "sizing/make_size_grid.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::cli {
namespace {

constexpr std::uint64_t kLeastBytesForMesh = 1 << 20;

// Adds the name of the image to errors.
template <class Ask>
auto of_image(const std::string& path, const Ask& ask) {
  try {
    return ask();
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
}

void refuse_coarse_sampling(const MeshCommand& command, const LabelImage& image) {
  double longest_mm = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    longest_mm = std::max(longest_mm, image.size[axis] * image.spacing[axis]);
  if (command.meshing.sizes.delta_mm > longest_mm)
    throw InputError(fmt::format("{}: {} {:g} mm is longer than the image, {:g} mm", command.image.path,
                                 spelled("delta"), command.meshing.sizes.delta_mm, longest_mm));
}

// Throws InputError if the estimate exceeds the memory or the cell numbers. An element limit below the
// estimate bounds both.
void refuse_what_cannot_fit(const std::string& image_path, const LabelImage& image,
                            const MeshingOptions& options, std::uint64_t limit_bytes, int num_ranks) {
  const Estimate expected = of_image(image_path, [&] {
    const auto grid = make_size_grid(image, options.sizes, loop_threads(options.team));
    return estimate(image, options, grid.get(), num_ranks);
  });
  const double mesh_bytes = expected.cells * kPeakBytesPerMeshCell,
               others = expected.memory_bytes - mesh_bytes;
  const double memory_bytes = std::isfinite(mesh_bytes) ? others + mesh_bytes / num_ranks : mesh_bytes;
  const double left = static_cast<double>(limit_bytes) - others;
  const std::string more_ranks =
      num_ranks > 1 && left > 0
          ? fmt::format(", or {} or more ranks of this memory", num_ranks_for(expected.cells, left))
          : "";
  const double most_cells = options.limits.max_elements > 0 ? static_cast<double>(options.limits.max_elements)
                                                            : std::numeric_limits<double>::infinity();
  if (memory_bytes > static_cast<double>(limit_bytes) && most_cells >= expected.cells)
    throw InputError(fmt::format(
        "{}: these options need about {:.2g} cells and {:.3g} GiB of memory{}; the limit is {:.3g} GiB; "
        "use a larger radius or delta, or {}{}",
        image_path, expected.cells, memory_bytes / kBytesPerGib, num_ranks > 1 ? " per rank" : "",
        static_cast<double>(limit_bytes) / kBytesPerGib, spelled("max-memory-gib"), more_ranks));
  const double stored_cells = std::min(most_cells, kStoredCellsPerMeshCell * expected.cells) / num_ranks;
  if (stored_cells > static_cast<double>(kMostStoredCells))
    throw InputError(
        fmt::format("{}: these options need about {:.2g} cells{} during meshing, including those of the "
                    "background, and at most 2^30 are supported; use a larger radius or delta, "
                    "or a smaller {}",
                    image_path, stored_cells, num_ranks > 1 ? " per rank" : "", spelled("max-elements")));
}

// Returns the rest of the limit after program, image, transform and local sizes.
std::uint64_t bytes_for_mesh(std::uint64_t limit_bytes, const std::string& image_path,
                             const LabelImage& image, const MeshingOptions& options, int num_ranks) {
  std::uint64_t others = resident_bytes() +
                         transform_bytes(image, limit_bytes, loop_threads(options.team), num_ranks) +
                         bytes_of_size_grid(image, options.sizes) + kBytesOfOutput;
  if (options.smoothing_mm > 0) others += image.num_voxels() * kBytesPerSmoothedVoxel;
  if (others + kLeastBytesForMesh <= limit_bytes) return limit_bytes - others;
  throw InputError(fmt::format(
      "{}: the image takes {:.3g} GiB, which leaves no room for a mesh below the limit of {:.3g} GiB",
      image_path, static_cast<double>(others) / kBytesPerGib,
      static_cast<double>(limit_bytes) / kBytesPerGib));
}

}  // namespace

std::uint64_t memory_limit_bytes(const MeshCommand& command) {
  if (command.max_memory.bytes > 0) return command.max_memory.bytes;
  return available_memory_bytes() / 100 * kPercentOfAvailableMemory;
}

std::uint64_t bytes_for_image(std::uint64_t limit_bytes) {
  return limit_bytes - std::min(limit_bytes, resident_bytes() + kBytesOfOutput);
}

MeshingOptions options_as_given(const MeshCommand& command, const LabelImage& image,
                                std::uint64_t limit_bytes) {
  MeshingOptions options = command.meshing;
  options.sizes.radius_of_mm = lengths_by_value(command.radius_of_mm, image, command.image.path);
  options.sizes.near = near_by_value(command.size_near, image, command.image.path);
  if (!command.size_image_path.empty())
    options.sizes.image = std::make_shared<const SizeImage>(
        read_size_image(command.size_image_path, bytes_for_image(limit_bytes)));
  refuse_coarse_sampling(command, image);
  if (options.smoothing_mm > 0)
    of_image(command.image.path, [&] { check_width(image, options.smoothing_mm); });
  return options;
}

MeshingOptions options_for_image(const MeshCommand& command, const LabelImage& image,
                                 std::uint64_t limit_bytes, int num_ranks) {
  MeshingOptions options = options_as_given(command, image, limit_bytes);
  refuse_what_cannot_fit(command.image.path, image, options, limit_bytes, num_ranks);
  options.limits.max_memory_bytes =
      bytes_for_mesh(limit_bytes, command.image.path, image, options, num_ranks);
  return options;
}

}  // namespace podm::cli
