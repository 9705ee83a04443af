// Replays a linearization log, or the result of merge_logs(), on one thread: the serial run that a parallel
// run claims to equal. Also the log of one of several ranks, with the vertices that it learnt.
#pragma once

#include <memory>

#include "delaunay/mesh.h"
#include "podm/operation_log.h"

namespace podm {

/// The triangulation that the logged operations make, one after another. Throws InputError, naming the
/// operation, if an operation cannot be carried out as logged. Throws std::bad_alloc.
std::unique_ptr<Mesh> replay(const OperationLog& log);

}  // namespace podm
