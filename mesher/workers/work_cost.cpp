#include "workers/work_cost.h"

namespace podm {

double attempt_seconds(const Work& work, const TimeCosts& costs, bool takes_locks) {
  const double seconds =
      costs.list_looked_up + costs.classified * static_cast<double>(work.classified) +
      costs.searched * static_cast<double>(work.searches) + costs.tested * static_cast<double>(work.tests) +
      costs.created * static_cast<double>(work.created) + costs.planned * static_cast<double>(work.planned);
  return takes_locks ? (1 + costs.locked) * seconds : seconds;
}

}  // namespace podm
