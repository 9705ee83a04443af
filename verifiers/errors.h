// The error that every part of the verifier throws when the input or an option is at fault.
#pragma once

#include <stdexcept>

namespace podm::verify {

/// what() names the file, the place in it (line, byte offset or XML element) and the fault. Exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace podm::verify
