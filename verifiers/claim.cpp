#include "claim.h"

namespace podm::verify {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "fail";
    case Verdict::kNotRun:
      break;
  }
  return "not_run";
}

}  // namespace podm::verify
