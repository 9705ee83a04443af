#include "experiments/claim_names.h"

#include <fmt/format.h>

#include <map>

namespace podm::bench {

void check_claim_names(const std::vector<Experiment>& experiments) {
  std::map<std::string, std::string> places;
  const auto add = [&](const auto& claim) {
    const auto [known, is_new] = places.emplace(claim.name, claim.place);
    if (!is_new)
      throw InputError(
          fmt::format("{}: a second claim '{}'; the first is in {}", claim.place, claim.name, known->second));
  };
  for (const Experiment& experiment : experiments) {
    for (const Claim& claim : experiment.claims) add(claim);
    for (const WithdrawnClaim& claim : experiment.withdrawn) add(claim);
  }
}

}  // namespace podm::bench
