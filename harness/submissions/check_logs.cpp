#include <fmt/format.h>

#include "rows/codec.h"
#include "submissions/checks.h"
#include "submissions/parse.h"
#include "trials/trial_logs.h"
#include "trials/verification.h"

namespace podm::bench {
namespace {

bool is_key_of_row(const std::string& key) {
  bool is_own = false;
  const auto compare = [&](const auto& field) { is_own = is_own || key == field.key; };
  std::apply([&](const auto&... fields) { (compare(fields), ...); }, Row::fields_before());
  std::apply([&](const auto&... fields) { (compare(fields), ...); }, Row::fields_after());
  return is_own;
}

// The keys of the mesher's record that a row repeats. The verifier's verdicts replace the mesher's.
bool is_repeated(const std::string& key) { return !is_key_of_row(key) && key != "verdicts"; }

std::string in_short(const Json& json) {
  constexpr std::size_t kMost = 60;
  const std::string text = json.dump();
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

// Returns the first difference between the row and the record that the mesher wrote.
std::string fault_of_record(const Json& row, const std::string& text) {
  const Json record = parse_untrusted(text);
  if (!record.is_object()) return "its log of the mesher is not a record";
  for (const auto& [key, value] : record.items())
    if (is_repeated(key) && row.value(key, Json()) != value)
      return fmt::format("{} is {}, in its log {}", key, in_short(row.value(key, Json())), in_short(value));
  const Json input = record.value("input", Json());
  const Json hash = input.is_object() ? input.value("sha256", Json()) : Json();
  if (!hash.is_null() && row["input"].value("sha256", Json()) != hash)
    return fmt::format("the hash of its input is {}, in its log {}",
                       in_short(row["input"].value("sha256", Json())), in_short(hash));
  return "";
}

// Returns the first difference between the row's verdicts and the report that podm-verify wrote.
std::string fault_of_report(const MeshRecord& mesh, const std::string& text) {
  const auto verdicts = verdicts_of_report(parse_untrusted(text));
  if (!verdicts) return "its log of podm-verify is not a report";
  if (!mesh.verdicts || verdicts->size() != mesh.verdicts->size())
    return "its log of podm-verify has other claims";
  for (const auto& [claim, verdict] : *verdicts) {
    const Proof* const stated = mesh.verdicts->find(claim);
    if (stated == nullptr || *stated != verdict)
      return fmt::format("{} is {}, in its log {}", claim, stated == nullptr ? "absent" : to_string(*stated),
                         to_string(verdict));
  }
  return "";
}

}  // namespace

void check_logs(const Submission& submission, Faults& faults) {
  for (const auto& [row, line, logs] : submission.rows) {
    const auto add = [&, &named = row](const std::string& fault) {
      if (!fault.empty()) faults.push_back({"logs", fmt::format("{}: {}", name_of(named), fault)});
    };
    if (!row.mesh && !row.measured) continue;
    const auto record = logs.find(kRecordName);
    add(record == logs.end() ? "the log of the mesher is missing" : fault_of_record(*line, record->second));
    if (!row.mesh) continue;
    const auto report = logs.find(kReportName);
    add(report == logs.end() ? "the log of podm-verify is missing"
                             : fault_of_report(*row.mesh, report->second));
  }
}

}  // namespace podm::bench
