#include "experiments/round_probes.h"

#include <array>
#include <utility>

namespace podm::bench {
namespace {

// Sets each value of `probe` to the better one of both.
void improve(ProbeRecord& probe, const ProbeRecord& other) { probe = best_of(std::array{probe, other}); }

}  // namespace

Probe RoundProbes::settled() {
  Probe probe = source_();
  auto* const values = std::get_if<ProbeRecord>(&probe);
  if (!values || !repeats_) return probe;
  const auto is_slow = [&] { return differ(std::array{best_of(std::array{*best_, *values}), *values}); };
  for (int repeat = 1; best_ ? repeat < kMostRepeats && is_slow() : repeat < kFirstRepeats; ++repeat)
    if (const Probe other = source_(); const auto* const more = std::get_if<ProbeRecord>(&other))
      improve(*values, *more);
  if (best_)
    improve(*best_, *values);
  else
    best_ = *values;
  return probe;
}

Probe RoundProbes::begin() {
  const auto last = std::exchange(last_, std::nullopt);
  return last ? *last : settled();
}

Probe RoundProbes::end() {
  last_ = settled();
  return *last_;
}

bool has_moved(const std::vector<Probe>& probes_of_round) {
  std::vector<ProbeRecord> known;
  for (const Probe& probe : probes_of_round)
    if (const auto* const values = std::get_if<ProbeRecord>(&probe)) known.push_back(*values);
  return differ(known);
}

}  // namespace podm::bench
