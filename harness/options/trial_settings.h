// The settings of a trial: the image, the mesher's options, the number of repeats, and limits.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace podm::bench {

/// The part of an evaluation that a trial belongs to; each tier includes the tiers before it.
enum class Tier { kKickTires, kDefault, kFull };
/// "kick-tires", "default", "full".
std::string to_string(Tier tier);
/// Throws InputError that lists the tiers.
Tier parse_tier(const std::string& text);

/// The settings of a mesh that is made a given number of times.
struct Trial {
  std::string name;        ///< the file's name for it, then ",key=value" of each key given as an array
  std::string image;       ///< a file or phantom:NAME[@SIZE]; empty: the trial makes no mesh
  bool if_exists = false;  ///< when the image file is absent, skip the trial and report it
  nlohmann::ordered_json options = nlohmann::ordered_json::object();  ///< the mesher's, by the file's keys
  int repeats = 1, warmups = 0;
  double timeout_s = 0;
  double memory_limit_gib = 0;  ///< 0: no limit
  std::uint64_t memory_limit_bytes() const {
    return static_cast<std::uint64_t>(memory_limit_gib * 1024 * 1024 * 1024);
  }
  Tier tier = Tier::kDefault;
};

/// True if the trial makes a mesh; false if it measures the machine.
inline bool makes_mesh(const Trial& trial) { return !trial.image.empty(); }

bool is_phantom(const std::string& image);

/// Returns the phantom with `factor` times as many voxels; nothing for another image or a phantom without a
/// size.
std::optional<std::string> grown(const std::string& image, double factor);

/// True if the trial's image is a phantom or a file that exists.
bool image_exists(const Trial& trial);

}  // namespace podm::bench
