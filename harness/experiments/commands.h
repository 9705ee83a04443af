// Commands of podm-bench that run experiments and judge their claims. Each returns the exit code; all throw
// InputError.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "errors.h"
#include "options/trial_settings.h"
#include "process/programs.h"

namespace podm::bench {

/// The default folders.
inline constexpr const char *kResultsFolder = "results/runs", *kExperimentsFolder = "experiments";

struct RunCommand {
  std::vector<std::string> experiment_paths;
  std::string only;                 ///< a shell pattern of trial names; empty: all
  std::optional<Tier> tier;         ///< trials of this tier and lower ones; unset: all
  std::vector<std::string> images;  ///< files and folders of files; replace all inputs; none: the inputs
  std::string results_folder = kResultsFolder;
  std::uint64_t order_seed = 1;
  Programs programs;
  bool again = false;  ///< also run what is measured already
  bool keep = false;   ///< keep meshes and messages
};

/// Runs the turns that are not measured yet and prints the table.
int run(const RunCommand& command);

/// Prints the turns that run() would run and their cost; writes no file.
int dry_run(const RunCommand& command);

/// Prints title, tier, trials and time of the experiments in a folder.
int list(const std::string& folder);

/// Judges the claims of experiments by the rows of a folder of results and prints a table of the verdicts.
/// Also writes them as JSON unless `json_path` is empty. Verdicts do not change the exit code.
int verdicts(const std::vector<std::string>& experiment_paths, const std::string& results_folder,
             const std::string& json_path);

}  // namespace podm::bench
