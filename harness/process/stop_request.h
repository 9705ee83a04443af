// A user ends a run of podm-bench by Ctrl-C (SIGINT) or SIGTERM.
#pragma once

#include <functional>

namespace podm::bench {

/// Called a few times per second during a run; true ends the run.
using StopQuery = std::function<bool()>;

/// From now on SIGINT and SIGTERM do not end this program; they are remembered. The query returns true once a
/// signal has come.
StopQuery stop_on_signals();

}  // namespace podm::bench
