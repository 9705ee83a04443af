#include "claim.h"

#include <nlohmann/json.hpp>

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

std::shared_ptr<nlohmann::json> ClaimResult::empty_details() {
  return std::make_shared<nlohmann::json>(nlohmann::json::object());
}

}  // namespace podm::verify
