#include "claim.h"

#include <array>
#include <nlohmann/json.hpp>

namespace podm::verify {

std::string to_string(Verdict verdict) {
  constexpr std::array kWords{"pass", "fail", "not_run"};
  return kWords[static_cast<std::size_t>(verdict)];
}

std::shared_ptr<nlohmann::json> ClaimResult::empty_details() {
  return std::make_shared<nlohmann::json>(nlohmann::json::object());
}

}  // namespace podm::verify
