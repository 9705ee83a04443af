// An experiment: which trials to run, as written in experiments/*.toml. The format is in
// experiments/README.md.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace podm::bench {

/// The user's input is at fault; what() names the file, the place and the fault. Exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One mesh to make. Lengths 0 and elements 0: left to the mesher.
struct Trial {
  std::string name;
  std::string image;       ///< a file or phantom:NAME[@SIZE]
  bool if_exists = false;  ///< skip the trial, saying so, when the image file is absent
  double radius_mm = 0, delta_mm = 0;
  std::uint64_t target_elements = 0;
  int threads = 1;
  double timeout_s = 0;
};

struct Experiment {
  std::string name;  ///< the file's name without .toml
  std::string title, claim;
  double expected_minutes = 0;
  std::vector<Trial> trials;  ///< in the order of the file
};

/// Throws InputError "file:line:column: fault" on anything that is not exactly the format.
Experiment read_experiment(const std::string& path);

/// Paths of the *.toml of a folder, sorted. Throws InputError when it cannot be read.
std::vector<std::string> experiment_files(const std::string& folder);

/// Whether the trial's image is a phantom or a file that exists.
bool image_exists(const Trial& trial);

}  // namespace podm::bench
