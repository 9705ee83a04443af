// Where the time of workers goes.
#pragma once

namespace podm {

/// Seconds that one worker did not bring the mesh on, by cause.
struct Overhead {
  double contention_s = 0, begging_s = 0, rollback_s = 0;
};

}  // namespace podm
