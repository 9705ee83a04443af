// The number of threads from which --algorithm auto is pdr-podm, and who says so.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/options.h"

namespace podm::cli {

/// The variable that names the file measured by podm-bench for this machine.
inline constexpr const char* kCrossoverVariable = "PODM_CROSSOVER";

struct Crossover {
  int threads = kDefaultCrossover;
  nlohmann::ordered_json source;  ///< for the record: default, option or file, and what the file tells
  std::string warning;            ///< measured on another processor; empty: none
};

/// --crossover decides, a number or a file; else, when `auto` runs on this machine's own cores, the file that
/// kCrossoverVariable names; else the default. Throws InputError naming the file and the fault.
Crossover choose_crossover(const MeshCommand& command);

}  // namespace podm::cli
