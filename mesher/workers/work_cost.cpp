#include "workers/work_cost.h"

namespace podm {

namespace {

// A cell that is examined: its label and bound, R3 to R5; the search for the nearest point of the isosurface;
// a cell tested against a point; a cell made and glued, the clearing of its page and the cells that removals
// leave included.
constexpr double kClassified = 0.19e-6, kSearched = 0.435e-6, kTested = 0.0225e-6, kCreated = 0.0945e-6;
// A cell that R7 plans, to carry it out or not.
constexpr double kPlanned = 0.2e-6;
// Locks make work take so much longer.
constexpr double kLocked = 1.04;

}  // namespace

double attempt_seconds(const Work& work, bool takes_locks) {
  const double seconds =
      kListLookedUp + kClassified * static_cast<double>(work.classified) +
      kSearched * static_cast<double>(work.searches) + kTested * static_cast<double>(work.tests) +
      kCreated * static_cast<double>(work.created) + kPlanned * static_cast<double>(work.planned);
  return takes_locks ? kLocked * seconds : seconds;
}

}  // namespace podm
