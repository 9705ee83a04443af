// The machine of the workers' tests: two sockets of two nodes of three workers.
#pragma once

#include "workers/begging_list.h"

namespace podm::test {

inline const WorkerGroups kNested{{0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}, {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}};

}  // namespace podm::test
