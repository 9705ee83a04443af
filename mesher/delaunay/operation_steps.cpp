#include "delaunay/operation.h"

#include "delaunay/operation_steps.h"

namespace podm {

template class Operation<NoLocks>;
template class Operation<VertexLocks>;

}  // namespace podm
