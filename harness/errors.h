// The exception for errors of the user, and the exit codes of podm-bench.
#pragma once

#include <stdexcept>

namespace podm::bench {

inline constexpr int kExitMissed = 1, kExitInput = 2, kExitInternal = 3;

/// The user's input is at fault. what() names the file, the place and the fault. Exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace podm::bench
