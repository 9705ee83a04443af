// What `podm info` tells of an image.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "process/ask.h"
#include "rows/row.h"

namespace podm::bench {

struct ImageInfo {
  std::vector<std::string> command;  ///< that asked
  Reply reply;
  std::optional<ImageSize> size;  ///< nothing where the mesher cannot read the image
};

/// Asks the mesher for an image, a file or phantom:NAME[@SIZE].
ImageInfo ask_for_info(const std::string& podm, const std::string& image,
                       const StopQuery& stop_requested = {});

}  // namespace podm::bench
