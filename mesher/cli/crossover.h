// The decision of --algorithm auto: the number of threads from which on it runs podm-home, and the source of
// this number. Without a source, the decision depends on whether the threads are on several NUMA nodes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/options/options.h"

namespace podm::cli {

/// The environment variable that names the file measured by podm-bench on this machine.
inline constexpr const char* kCrossoverVariable = "PODM_CROSSOVER";

struct Crossover {
  int threads = 0;                ///< 0: NUMA nodes decide
  nlohmann::ordered_json source;  ///< for the record: default, option or file, and the contents of the file
  std::string warning;            ///< the file was measured on another processor; empty: no warning
};

/// Returns the crossover. The option --crossover has priority, as a number or a file. Otherwise, if `auto`
/// runs on this machine's own cores, it is read from the file that kCrossoverVariable names. Otherwise NUMA
/// nodes decide. Throws InputError that names the file and the fault.
Crossover choose_crossover(const MeshCommand& command);

}  // namespace podm::cli
