// podm info --plan and podm.plan: the predicted cost of a run, and the parts that its mesh will lose.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/options/options.h"
#include "image/components.h"
#include "image/thin_parts.h"
#include "podm/label_image.h"
#include "prediction/predict_cost.h"

namespace podm::cli {

struct Plan {
  int threads = 1;  ///< threads of refinement
  Cost cost;
  double memory_bytes = 0;  ///< peak memory of the whole process
  double read_s = 0, transform_s = 0;
  std::vector<ThinPart> thin_parts;
  /// Volumes of each label's components, mm^3, by label, the largest first.
  std::vector<std::vector<double>> components_mm3;

  double seconds() const { return read_s + transform_s + cost.mesh_s; }
};

/// Plans the run of a command on its image, which took `read_s` seconds to read. Call it directly after
/// reading: the memory of the process must be that of a run at this point. Throws InputError as the run
/// would, except for a lack of memory.
Plan make_plan(const MeshCommand& command, const LabelImage& image, double read_s);

nlohmann::ordered_json plan_json(const Plan& plan, const LabelImage& image);
std::string plan_text(const Plan& plan, const LabelImage& image);

}  // namespace podm::cli
