// The numbers of workers.
#pragma once

#include <cstdint>

namespace podm {

/// Workers of a run are numbered from 0 on.
using WorkerId = std::uint32_t;
inline constexpr WorkerId kNoWorker = 0xffffffffu;

}  // namespace podm
