// PODM: Parallel Optimistic Delaunay Meshing of an image, from the six cells of a box to a mesh that obeys
// R1..R6.
#pragma once

#include <memory>

#include "refine/executor.h"
#include "refine/rules.h"

namespace podm {

struct Refinement {
  std::unique_ptr<Mesh> mesh;
  StopReason stop_reason = StopReason::kComplete;
  Counters counters;
};

/// How many workers run, and how they get out of each other's way.
struct Crew {
  int threads = 1;  // 1: no locks
  Contention contention = Contention::kLocal;
  std::uint64_t seed = 1;
};

/// `object`: bounds of the foreground. `cell_capacity`: the most cells the store may hold.
Refinement podm(const Isosurface& isosurface, const Box& object, double delta_mm, const SizeField& sizes,
                std::size_t cell_capacity, const Crew& crew, Watch& watch);

}  // namespace podm
