// Operations and workers that keep to a leaf: the kernel and the rules know nothing of leaves.
#include "algorithms/leaf_locks.h"

#include "delaunay/operation_steps.h"
#include "refine/attempt.h"

namespace podm {

template class Operation<LeafLocks<NoLocks>>;
template class Operation<LeafLocks<VertexLocks>>;
template class Worker<LeafLocks<NoLocks>>;
template class Worker<LeafLocks<VertexLocks>>;

}  // namespace podm
