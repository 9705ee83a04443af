// The size of an image and of its voxels, from `podm info`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "process/ask.h"
#include "rows/row.h"

namespace podm::bench {

struct ImageInfo {
  std::vector<std::string> command;  ///< the command that was run
  Reply reply;
  std::optional<ImageSize> size;           ///< unset if the mesher cannot read the image
  std::optional<double> voxel_volume_mm3;  ///< unset likewise
};

/// Asks the mesher about an image, a file or phantom:NAME[@SIZE].
ImageInfo ask_for_info(const std::string& podm, const std::string& image,
                       const StopQuery& stop_requested = {});

}  // namespace podm::bench
