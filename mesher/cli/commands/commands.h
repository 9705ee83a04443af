// The commands of the program, one function each. They return the exit code: 0, or 1 if the run misses a
// guarantee, a limit or a log's claim. They throw on faults.
#pragma once

#include "cli/options/options.h"

namespace podm::cli {

int run(const MeshCommand& command);
int run(const ReplayCommand& command);
int run(const ConvertCommand& command);
int run(const InfoCommand& command);
int run(const PhantomCommand& command);
int run(const ViewCommand& command);
int run(const ServeCommand& command);
int run(const ShowText& show);

}  // namespace podm::cli
