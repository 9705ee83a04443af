#include "refine/worker.h"

#include "refine/worker_impl.h"

namespace podm {

template class Worker<NoLocks>;
template class Worker<VertexLocks>;

}  // namespace podm
