// Multiplies one constant of a described machine, or one cost of work, by a factor. This shows what depends
// on that constant. Where the description has no line_transfer or no page_fault, the factor multiplies 100 ns
// or 1 us.
#pragma once

#include <string>

#include "runtime/machine_model.h"

namespace podm {

/// NAME=FACTOR, as in "retries=2"; a factor of 0 switches the constant off.
struct CostFactor {
  std::string name;
  double factor = 1;

  /// Throws TopologyError if the text has no valid factor, or names no constant.
  static CostFactor parse(const std::string& text);
  /// Throws TopologyError if the machine cannot have such a constant.
  void apply_to(MachineModel& machine) const;
};

}  // namespace podm
