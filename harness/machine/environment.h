// The machine's state and the build: what a measurement needs told beside it. What cannot be known reads
// "unavailable: why".
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "trials/verification.h"

namespace podm::bench {

/// What stays during a run: sources, build, libraries, limits.
nlohmann::ordered_json environment_of_run();

/// What may change between trials: load, memory available, governor, huge pages and NUMA balancing.
nlohmann::ordered_json environment_now();

/// Hash and --version of mesher and verifier. Throws InputError naming a program that cannot be read.
nlohmann::ordered_json describe_programs(const Programs& programs);

}  // namespace podm::bench
