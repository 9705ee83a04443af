// The message of a call that is refused.
#pragma once

#include <string>

namespace podm {

/// Returns the message of the `Error` that `call()` throws, or "no error".
template <class Error, class Call>
std::string fault_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace podm
