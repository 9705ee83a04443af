// podm info --plan and podm.plan: what a run will cost and lose.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/options/options.h"
#include "image/components.h"
#include "image/thin_parts.h"
#include "podm/label_image.h"
#include "prediction/predict_cost.h"

namespace podm::cli {

struct Plan {
  int threads = 1;  ///< that refine
  Cost cost;
  double memory_bytes = 0;  ///< peak of the whole process
  double read_s = 0, transform_s = 0;
  std::vector<ThinPart> thin_parts;
  /// Volumes of a label's components, by label, the largest first, mm^3.
  std::vector<std::vector<double>> components_mm3;

  double seconds() const { return read_s + transform_s + cost.mesh_s; }
};

/// Plans the run of a command on its image, which took so long to read and has just been read: what the
/// process takes now is what a run would. Throws InputError as the run would, but for a lack of memory.
Plan make_plan(const MeshCommand& command, const LabelImage& image, double read_s);

nlohmann::ordered_json plan_json(const Plan& plan, const LabelImage& image);
std::string plan_text(const Plan& plan, const LabelImage& image);

}  // namespace podm::cli
