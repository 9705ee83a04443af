// One constant of a described machine, or of what work takes, times a factor: what hangs on that constant?
#pragma once

#include <string>

#include "runtime/machine_model.h"

namespace podm {

/// NAME=FACTOR, as in "retries=2"; a factor of 0 switches the constant off.
struct CostFactor {
  std::string name;
  double factor = 1;

  /// Throws TopologyError when the text is no factor, or its name none of a constant.
  static CostFactor parse(const std::string& text);
  /// Throws TopologyError when the machine cannot have such a constant.
  void apply_to(MachineModel& machine) const;
};

}  // namespace podm
