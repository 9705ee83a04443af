#include "experiments/round_probes.h"

#include <utility>

namespace podm::bench {

Probe RoundProbes::begin() {
  const auto last = std::exchange(last_, std::nullopt);
  return last ? *last : source_();
}

Probe RoundProbes::end() {
  last_ = source_();
  return *last_;
}

bool has_moved(const std::vector<Probe>& probes_of_round) {
  std::vector<ProbeRecord> known;
  for (const Probe& probe : probes_of_round)
    if (const auto* const values = std::get_if<ProbeRecord>(&probe)) known.push_back(*values);
  return differ(known);
}

}  // namespace podm::bench
