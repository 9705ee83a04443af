#include "refine/worker.h"

#include "refine/attempt.h"

namespace podm {

template class Worker<NoLocks>;
template class Worker<VertexLocks>;

}  // namespace podm
