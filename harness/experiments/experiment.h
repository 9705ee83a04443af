// An experiment: which trials to run, as written in experiments/*.toml. The format is in
// experiments/README.md.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "errors.h"
#include "experiments/claim.h"

namespace podm::bench {

/// How much of an evaluation a trial belongs to; each includes those before it.
enum class Tier { kKickTires, kDefault, kFull };
/// "kick-tires", "default", "full".
std::string to_string(Tier tier);
/// Throws InputError naming the tiers there are.
Tier parse_tier(const std::string& text);

/// The settings of one mesh to make, some number of times.
struct Trial {
  std::string name;        ///< the file's name for it, then ",key=value" of each key given as an array
  std::string image;       ///< a file or phantom:NAME[@SIZE]; empty: it makes no mesh
  bool if_exists = false;  ///< skip the trial, saying so, when the image file is absent
  nlohmann::ordered_json options = nlohmann::ordered_json::object();  ///< the mesher's, by the file's keys
  int repeats = 1, warmups = 0;
  double timeout_s = 0;
  double memory_limit_gib = 0;  ///< 0: none
  std::uint64_t memory_limit_bytes() const {
    return static_cast<std::uint64_t>(memory_limit_gib * 1024 * 1024 * 1024);
  }
  Tier tier = Tier::kDefault;
};

struct Experiment {
  std::string name;                 ///< the file's name without .toml
  std::string title, claim, paper;  ///< the last may be empty
  Tier tier = Tier::kDefault;
  double expected_minutes = 0;
  bool stores_crossover = false;          ///< its end stores it for podm mesh --algorithm auto: crossover.h
  std::vector<Trial> trials;              ///< the matrix, expanded, in the order of the file
  std::vector<Claim> claims;              ///< what its rows are to show; at least one
  std::vector<WithdrawnClaim> withdrawn;  ///< what it claimed once

  /// Times that a mesh is made, warm-ups included.
  std::size_t num_turns() const;
};

/// Throws InputError "file:line:column: fault" on anything that is not exactly the format. `images`, where
/// there are some, stand for all inputs, each an input of its own; they are relative to the working folder.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& images = {});

/// Paths of the *.toml of a folder, sorted. Throws InputError when it cannot be read.
std::vector<std::string> experiment_files(const std::string& folder);

/// Whether the trial makes a mesh; otherwise it measures the machine.
inline bool makes_mesh(const Trial& trial) { return !trial.image.empty(); }

bool is_phantom(const std::string& image);

/// The phantom with `factor` times as many voxels; nothing for another image or a phantom without its size.
std::optional<std::string> grown(const std::string& image, double factor);

/// Whether the trial's image is a phantom or a file that exists.
bool image_exists(const Trial& trial);

}  // namespace podm::bench
