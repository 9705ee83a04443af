// How a person ends what podm-bench runs: by Ctrl-C, or by the signal that asks a program to end.
#pragma once

#include <functional>

namespace podm::bench {

/// Asked a few times a second while something runs; true ends it.
using StopQuery = std::function<bool()>;

/// From now on SIGINT and SIGTERM no longer end this program but are remembered. The query tells whether one
/// has come.
StopQuery stop_on_signals();

}  // namespace podm::bench
