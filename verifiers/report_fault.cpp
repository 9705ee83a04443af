#include "report_fault.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "errors.h"
#include "verify.h"

namespace podm::verify {

void let_writes_fail() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

int report_fault(const std::string& prefix) {
  try {
    throw;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}{}\n", prefix, error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "{}out of memory\n", prefix);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}internal error: {}\n", prefix, error.what());
  }
  return kInternal;
}

}  // namespace podm::verify
