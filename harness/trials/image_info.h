// The size of an image, from `podm info`.
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
  std::optional<ImageSize> size;  ///< unset if the mesher cannot read the image
};

/// Asks the mesher about an image, a file or phantom:NAME[@SIZE].
ImageInfo ask_for_info(const std::string& podm, const std::string& image,
                       const StopQuery& stop_requested = {});

}  // namespace podm::bench
