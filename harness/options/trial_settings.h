// What is set of a trial: the image, the mesher's options, how often, within which limits.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

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

/// Whether the trial makes a mesh; otherwise it measures the machine.
inline bool makes_mesh(const Trial& trial) { return !trial.image.empty(); }

bool is_phantom(const std::string& image);

/// The phantom with `factor` times as many voxels; nothing for another image or a phantom without its size.
std::optional<std::string> grown(const std::string& image, double factor);

/// Whether the trial's image is a phantom or a file that exists.
bool image_exists(const Trial& trial);

}  // namespace podm::bench
