#include "gate/simulated_machine.h"

#include <cmath>

namespace podm::bench {

SimulatedMachine::SimulatedMachine(std::uint64_t seed, double noise)
    : random_(seed), order_(2, ~seed), noise_(noise) {
  wander_ = kWander * gauss();
}

double SimulatedMachine::run(double seconds) {
  const double kept = std::exp(-seconds / 600);
  wander_ = kept * wander_ + kWander * std::sqrt(1 - kept * kept) * gauss();
  if (uniform() < seconds / 300) jump_ = kWander * gauss();
  const double disturbance = uniform() < 0.1 ? -0.25 * std::log1p(-uniform()) : 0;
  return seconds * std::exp(wander_ + jump_ + noise_ * gauss() + disturbance);
}

Round SimulatedMachine::round(double head_over_base) {
  Round round;
  for (const std::size_t process : order_.next())
    (process == 0 ? round.base_s : round.head_s) = run(process == 0 ? 1 : head_over_base);
  return round;
}

}  // namespace podm::bench
