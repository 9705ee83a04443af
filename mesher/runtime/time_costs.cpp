#include "runtime/time_costs.h"

#include <fmt/format.h>

namespace podm {

std::string time_model_text(const TimeCosts& costs) {
  std::string text = fmt::format("version {}\n", kTimeModelVersion);
  for (const auto& [name, member] : kTimeCosts) text += fmt::format("{} {}\n", name, costs.*member);
  return text;
}

}  // namespace podm
