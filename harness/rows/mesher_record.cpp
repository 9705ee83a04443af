#include "rows/mesher_record.h"

#include <algorithm>

namespace podm::bench {

double meshing_seconds(const ByName<double>& phases_s) {
  // Finding a radius, drawing a phantom, measuring the mesh, bettering its angles, writing it.
  constexpr std::array kNotMeshing{"calibrate", "draw", "perturb", "optimize", "exude", "measure", "write"};
  double seconds = 0;
  for (const auto& [phase, phase_s] : phases_s)
    if (std::find(kNotMeshing.begin(), kNotMeshing.end(), phase) == kNotMeshing.end()) seconds += phase_s;
  return seconds;
}

}  // namespace podm::bench
