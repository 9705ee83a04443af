// Commands of podm-bench for submissions. Each returns the exit code; all throw InputError.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "process/programs.h"
#include "submissions/manifest.h"

namespace podm::bench {

struct PackCommand {
  std::vector<std::string> experiments;  ///< files or names of experiments; none: all that have rows
  std::string results_folder, experiments_folder;
  std::string division = "closed", submitter;
  std::string declaration_path;  ///< a text; empty: none
  std::string output;
};

/// Packs rows, logs and hashes into an archive. If they break a rule, prints the faults and writes nothing.
int pack_submission(const PackCommand& command);

struct CheckCommand {
  std::string archive, experiments_folder;
  std::vector<std::string> images;  ///< files and folders with inputs of the rows
  Programs programs;
  std::size_t num_meshes = 3;         ///< meshes to make again
  std::optional<std::uint64_t> seed;  ///< draws the rows; unset: by the system's source of randomness
};

/// Judges an archive and prints VALID, or NOT VALID and the faults, to standard output.
int check_submission(const CheckCommand& command);

}  // namespace podm::bench
