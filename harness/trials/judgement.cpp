#include "trials/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "peers/peer.h"
#include "rows/record.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMesherSchema = 1;  // of the mesher's records
constexpr int kExitUnmet = 1;
constexpr int kExitRefused = 77;  // of a peer: peers/README.md

// Why `record` cannot be used; empty: it can. Asks only for what is read here and in the table.
std::string fault_of(const Json& record) {
  if (!record.is_object()) return "is not a JSON object";
  if (record.value("schema", Json()) != kMesherSchema)
    return fmt::format("is not of schema {}", kMesherSchema);
  const auto at = [&](const char* key) { return record.value(key, Json()); };
  const Json phases = at("phases_s");
  if (!phases.is_object() ||
      !std::all_of(phases.begin(), phases.end(), [](const Json& s) { return s.is_number(); }))
    return "has no seconds by phase";
  for (const char* count : {"cells", "vertices"})
    if (!at(count).is_number_unsigned()) return fmt::format("has no count '{}'", count);
  if (!at("refine_cells_per_second").is_number()) return "has no number 'refine_cells_per_second'";
  if (!at("guarantees").is_object()) return "has no 'guarantees'";
  if (!at("stop_reason").is_string()) return "has no 'stop_reason'";
  return {};
}

// Guarantees by name with the number of their misses, e.g. "radius_edge 3, facet_angle 1".
std::string unmet(const Json& record) {
  std::string text;
  for (const auto& [name, misses] : record["guarantees"].items())
    if (misses != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, misses.dump());
  if (record["stop_reason"] != "complete")
    text += fmt::format("{}stopped: {}", text.empty() ? "" : ", ", record["stop_reason"].get<std::string>());
  return text;
}

void judge_end(TrialResult& result) {
  using End = ProcessOutcome::End;
  result.reason = result.process.describe();
  if (result.process.end == End::kTimedOut) result.status = Status::kTimedOut;
  if (result.process.end == End::kInterrupted) result.status = Status::kInterrupted;
}

}  // namespace

void judge_measurement(const std::string& record_path, TrialResult& result) {
  judge_end(result);
  if (!result.process.succeeded()) return;
  std::ifstream file(record_path);
  Json record = Json::parse(file, nullptr, false);
  if (!record.is_object() || !record.value(kMemoryLevels, Json()).is_array()) {
    result.reason += ", without a record";
    return;
  }
  result.record = std::move(record);
  result.status = Status::kOk;
  result.reason.clear();
}

void judge(const Trial& trial, const std::string& record_path, TrialResult& result) {
  judge_end(result);
  const ProcessOutcome& process = result.process;
  if (process.end != ProcessOutcome::End::kExited) return;
  if (is_of_peer(trial) && process.exit_code == kExitRefused) result.status = Status::kSkipped;
  if (process.exit_code != 0 && process.exit_code != kExitUnmet) return;

  std::ifstream file(record_path);
  if (!file) {
    result.reason += ", without a record";
    return;
  }
  Json record = Json::parse(file, nullptr, false);
  if (is_of_peer(trial)) record = complete_record(trial, result.preparation, std::move(record));
  if (const std::string fault = fault_of(record); !fault.empty()) {
    result.reason += ", with a record that " + fault;
    return;
  }
  const std::string misses = unmet(record);
  result.record = std::move(record);
  if (process.exit_code == 0 && misses.empty()) {
    result.status = Status::kOk;
    result.reason.clear();
    return;
  }
  result.status = Status::kUnmet;
  if (!misses.empty()) result.reason = misses;
}

}  // namespace podm::bench
