// What rows say of the state of their machine while a trial ran.
#pragma once

#include "rows/row.h"

namespace podm::bench {

/// Other work kept more than a tenth of each processor that the trial could use busy. False where it is not
/// known.
bool is_disturbed(const Row& row);
/// The machine's speed moved during the row's round.
bool probe_moved(const Row& row);

}  // namespace podm::bench
