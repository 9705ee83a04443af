#include "trials/judgement.h"

#include <fmt/format.h>

#include <fstream>
#include <functional>

#include "rows/codec.h"
#include "trials/peer.h"

namespace podm::bench {
namespace {

constexpr int kExitUnmet = 1;
constexpr int kExitRefused = 77;  // a peer exits with it to decline a trial: peers/README.md

// Returns the missed guarantees with the number of misses, e.g. "radius_edge 3, facet_angle 1", and the stop
// reason of an incomplete run.
std::string unmet(const MeshRecord& record) {
  std::string text;
  for (const auto& [name, misses] : record.guarantees)
    if (misses != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, misses);
  if (record.stop_reason != kComplete)
    text += fmt::format("{}stopped: {}", text.empty() ? "" : ", ", record.stop_reason);
  return text;
}

// Returns the record that a program wrote. If it is missing or faulty, returns nothing and adds the fault to
// the reason.
template <class Record>
std::optional<Record> read_record(const std::string& path, const std::function<Json(Json)>& complete,
                                  TrialResult& result) {
  std::ifstream file(path);
  if (!file) {
    result.reason += ", without a record";
    return {};
  }
  try {
    return from_json<Record>(complete(Json::parse(file, nullptr, false)), "record");
  } catch (const FieldError& fault) {
    result.reason += fmt::format(", {}", fault.what());
    return {};
  }
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
  result.measured = read_record<MemoryLevelsRecord>(record_path, std::identity(), result);
  if (!result.measured) return;
  result.status = Status::kOk;
  result.reason.clear();
}

void judge(const Trial& trial, const std::string& record_path, TrialResult& result) {
  judge_end(result);
  const ProcessOutcome& process = result.process;
  if (process.end != ProcessOutcome::End::kExited) return;
  if (is_of_peer(trial) && process.exit_code == kExitRefused) result.status = Status::kSkipped;
  if (process.exit_code != 0 && process.exit_code != kExitUnmet) return;

  const auto complete = [&](Json record) {
    return is_of_peer(trial) ? complete_record(trial, result.preparation, std::move(record)) : record;
  };
  auto mesh = read_record<MeshRecord>(record_path, complete, result);
  if (mesh && mesh->schema != kMesherSchema) {
    result.reason += fmt::format(", record: is not of schema {}", kMesherSchema);
    return;
  }
  if (!mesh) return;
  result.mesh = std::move(mesh);
  const std::string misses = unmet(*result.mesh);
  if (process.exit_code == 0 && misses.empty()) {
    result.status = Status::kOk;
    result.reason.clear();
    return;
  }
  result.status = Status::kUnmet;
  if (!misses.empty()) result.reason = misses;
}

}  // namespace podm::bench
