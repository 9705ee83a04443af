// What a refused call says.
#pragma once

#include <string>

#include "podm/errors.h"

namespace podm {

/// The message of the InputError that `call()` throws, or "no error".
template <class Call>
std::string input_error_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace podm
