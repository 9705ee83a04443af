// Operations and workers that are confined to a leaf: the kernel and the rules do not depend on leaves.
#include "algorithms/leaf_locks.h"

#include "delaunay/operation_steps.h"
#include "refine/attempt.h"

namespace podm {

template class Operation<LeafLocks<NoLocks>>;
template class Operation<LeafLocks<VertexLocks>>;
template class Worker<LeafLocks<NoLocks>>;
template class Worker<LeafLocks<VertexLocks>>;

}  // namespace podm
