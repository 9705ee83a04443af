// Probes the machine's current speed by a pointer chase, a triad and a chain of additions. Each value is the
// best of several bursts.
#pragma once

#include <functional>
#include <span>

#include "rows/machine_record.h"

namespace podm::bench {

/// A round is marked when two of its probes differ by more than this factor in one of their values.
inline constexpr double kToleratedMove = 1.1;

/// Returns the best value of each kind. A disturbance that is shorter than the whole probe does not show.
/// There is at least one burst.
ProbeRecord best_of(std::span<const ProbeRecord> bursts);

/// True if two of the probes differ by more than kToleratedMove in the same value.
bool differ(std::span<const ProbeRecord> probes);

/// Probes the machine in a separate process. The memory of the probe then does not count in the peak memory
/// that the children of this process inherit. Takes about 0.2 s.
Probe probe_machine();

/// A function that probes the machine; tests replace it.
using ProbeSource = std::function<Probe()>;

}  // namespace podm::bench
