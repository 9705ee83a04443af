// Replay of a linearization log, or of merge_logs(), on one thread: the serial run that a parallel run claims
// to equal.
#pragma once

#include <memory>

#include "delaunay/mesh.h"
#include "podm/operation_log.h"

namespace podm {

/// The triangulation that the logged operations make, one after the other. Throws InputError, naming the
/// operation, when one cannot be carried out as logged; std::bad_alloc.
std::unique_ptr<Mesh> replay(const OperationLog& log);

}  // namespace podm
