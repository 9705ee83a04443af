// The machine's speed in a moment: a pointer chase, a triad and a chain of additions, each the best of
// bursts.
#pragma once

#include <functional>
#include <span>

#include "rows/machine_record.h"

namespace podm::bench {

/// A round is marked when two of its probes differ by more than this factor in one of their values.
inline constexpr double kToleratedMove = 1.1;

/// The best value of each kind: what disturbs a burst for less than the whole probe does not show. There is
/// at least one.
ProbeRecord best_of(std::span<const ProbeRecord> bursts);

/// Some two of the probes differ by more than kToleratedMove in the same value.
bool differ(std::span<const ProbeRecord> probes);

/// Probes the machine in a process of its own, whose memory then does not count in the peak memory that the
/// children of this one inherit. Takes some 0.2 s.
Probe probe_machine();

/// Probes the machine; made up in tests.
using ProbeSource = std::function<Probe()>;

}  // namespace podm::bench
