// The errors that this library throws. The library never prints and never exits.
#pragma once

#include <stdexcept>
#include <string>

namespace podm {

/// The input or an option is wrong; what() names the file or option and the fault. Exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The library itself is wrong: an invariant is broken. The user never causes it. Exit code 3.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

}  // namespace podm
