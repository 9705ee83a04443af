// PODM: Parallel Optimistic Delaunay Meshing of an image, from the six cells of a box to a mesh that obeys
// R1..R6.
#pragma once

#include <memory>

#include "podm/operation_log.h"
#include "refine/coordination.h"
#include "refine/executor.h"
#include "refine/rules.h"

namespace podm {

struct Refinement {
  std::unique_ptr<Mesh> mesh;
  StopReason stop_reason = StopReason::kComplete;
  Counters counters;
  double virtual_s = 0;  // of Executor::kVirtual
};

/// Who refines.
struct Crew {
  Executor executor = Executor::kThreads;
  CoordinationOptions coordination;  // one thread works without locks, unless `locks_alone`
  VirtualCost cost = VirtualCost::kMeasured;
  OperationLogWriter* log = nullptr;
  bool locks_alone = false;  // to measure what locks cost
};

/// `object`: bounds of the foreground. `cell_capacity`: the most cells the store may hold.
Refinement podm(const Isosurface& isosurface, const Box& object, double delta_mm, const SizeField& sizes,
                std::size_t cell_capacity, const Crew& crew, Watch& watch);

}  // namespace podm
