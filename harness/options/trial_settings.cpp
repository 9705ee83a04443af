#include "options/trial_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "errors.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> kTierNames = {"kick-tires", "default", "full"};

}  // namespace

std::string to_string(Tier tier) { return kTierNames[static_cast<std::size_t>(tier)]; }

Tier parse_tier(const std::string& text) {
  const auto* const found = std::find(kTierNames.begin(), kTierNames.end(), text);
  if (found == kTierNames.end())
    throw InputError(fmt::format("unknown tier '{}'; known tiers: {}", text, fmt::join(kTierNames, ", ")));
  return static_cast<Tier>(found - kTierNames.begin());
}

bool is_phantom(const std::string& image) { return image.starts_with("phantom:"); }

std::optional<std::string> grown(const std::string& image, double factor) {
  const std::size_t at = image.find('@');
  int size = 0;
  if (!is_phantom(image) || at == std::string::npos) return {};
  const char* const end = image.data() + image.size();
  if (std::from_chars(image.data() + at + 1, end, size).ptr != end) return {};
  return fmt::format("{}@{}", image.substr(0, at), std::lround(size * std::cbrt(factor)));
}

bool image_exists(const Trial& trial) {
  std::error_code error;
  return is_phantom(trial.image) || fs::exists(trial.image, error);
}

}  // namespace podm::bench
