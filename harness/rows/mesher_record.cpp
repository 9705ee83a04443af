#include "rows/mesher_record.h"

#include <algorithm>
#include <array>

namespace podm::bench {

double meshing_seconds(const ByName<double>& phases_s) {
  // Finding a radius, drawing a phantom, improving angles (perturb, optimize, exude), measuring, writing.
  constexpr std::array kNotMeshing{"calibrate", "draw", "perturb", "optimize", "exude", "measure", "write"};
  double seconds = 0;
  for (const auto& [phase, phase_s] : phases_s)
    if (std::find(kNotMeshing.begin(), kNotMeshing.end(), phase) == kNotMeshing.end()) seconds += phase_s;
  return seconds;
}

}  // namespace podm::bench
