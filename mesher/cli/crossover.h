// What --algorithm auto goes by: the number of threads from which on it is podm-home, and who says so; or,
// where nobody does, whether the threads are on several NUMA nodes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/options/options.h"

namespace podm::cli {

/// The variable that names the file measured by podm-bench for this machine.
inline constexpr const char* kCrossoverVariable = "PODM_CROSSOVER";

struct Crossover {
  int threads = 0;                ///< 0: by NUMA nodes
  nlohmann::ordered_json source;  ///< for the record: default, option or file, and what the file tells
  std::string warning;            ///< measured on another processor; empty: none
};

/// --crossover decides, a number or a file; else, when `auto` runs on this machine's own cores, the file that
/// kCrossoverVariable names; else NUMA nodes do. Throws InputError naming the file and the fault.
Crossover choose_crossover(const MeshCommand& command);

}  // namespace podm::cli
