#include "rows/measure.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "rows/measure_parts.h"

namespace podm::bench {

Value sum_of(const ByName<std::uint64_t>& parts) {
  double sum = 0;
  for (const auto& [name, number] : parts) sum += static_cast<double>(number);
  return {sum, ""};
}

Value quotient(const Value& dividend, const Value& divisor) {
  if (!dividend.number) return dividend;
  if (!divisor.number) return divisor;
  if (*divisor.number <= 0) return absent("a divisor is 0");
  return {*dividend.number / *divisor.number, ""};
}

Value cells(const Row& row) {
  return row.mesh ? Value{static_cast<double>(row.mesh->cells), ""} : absent("rows have no cells");
}

std::span<const Measure> measures() {
  static const std::vector<Measure> kAll = [] {
    std::vector<Measure> all;
    for (const auto& list :
         {measures_of_time(), measures_of_ranks(), measures_of_losses(), measures_of_mesh()})
      all.insert(all.end(), list.begin(), list.end());
    return all;
  }();
  return kAll;
}

const Measure* find_measure(const std::string& name) {
  for (const Measure& measure : measures())
    if (measure.name == name) return &measure;
  return nullptr;
}

bool fits(const Measure& measure, Basis basis) {
  switch (measure.meaning) {
    case kClock:
      return basis == Basis::kMeasured;
    case kVirtualClock:
      return basis == Basis::kSimulated;
    case kCost:
    case kCount:
      return basis != Basis::kAny;
    default:
      return true;
  }
}

bool varies(const Measure& measure) { return measure.meaning <= kCount; }

bool varies_between_runs(const Measure& measure, const Row& row) {
  if (!varies(measure) || row.basis == Basis::kSimulated) return false;
  return measure.meaning != kCount || asked_of(row).value("threads", 1) > 1;
}

bool is_yes_or_no(const Measure& measure) { return measure.meaning >= kAnswer; }

}  // namespace podm::bench
