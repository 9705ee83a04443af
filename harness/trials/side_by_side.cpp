#include "trials/side_by_side.h"

#include <fmt/format.h>

#include "machine/machine.h"
#include "options/option_keys.h"
#include "process/usable_processors.h"
#include "trials/judgement.h"

namespace podm::bench {
namespace {

// The entry of a copy in the row.
CopyRecord entry_of(int processor, const MeshRecord& record) {
  return {processor, record.cells, record.phases_s, record.refine_cells_per_second, record.cells_per_second};
}

// Returns the fault of a copy. The first copy must have status ok, so that it has a mesh.
std::string fault_of(const TrialResult& copy, const TrialResult& first) {
  if (copy.status != Status::kOk) return copy.reason;
  return copy.mesh->mesh_sha256 == first.mesh->mesh_sha256 ? "" : "another mesh";
}

// The trial takes the first fault.
void take_fault_of_copy(const TrialResult& copy, int number, TrialResult& result) {
  if (result.status != Status::kOk) return;
  const std::string fault = fault_of(copy, result);
  if (fault.empty()) return;
  result.status = copy.status == Status::kOk ? Status::kUnmet : copy.status;
  result.reason = fmt::format("copy {}: {}", number, fault);
}

}  // namespace

int num_copies(const Trial& trial) { return trial.options.value(kCopies, 0); }

std::string folder_of_copy(const std::string& scratch_folder, int copy) {
  return copy == 0 ? scratch_folder : fmt::format("{}/copy{}", scratch_folder, copy + 1);
}

void run_side_by_side(const Trial& trial, std::vector<ProcessRequest> requests,
                      const std::string& scratch_folder, const StopQuery& stop_requested,
                      TrialResult& result) {
  const std::vector<int> processors = usable_processor_ids();
  for (std::size_t i = 0; i < requests.size(); ++i) requests[i].processor = processors.at(i);
  const std::vector<ProcessOutcome> outcomes = run_processes(requests, stop_requested);
  std::vector<CopyRecord> entries;
  for (int i = 0; i < static_cast<int>(outcomes.size()); ++i) {
    const auto at = static_cast<std::size_t>(i);
    TrialResult copy;
    copy.preparation = result.preparation;
    copy.process = outcomes[at];
    judge(trial, folder_of_copy(scratch_folder, i) + kRecordName, copy);
    if (copy.mesh) entries.push_back(entry_of(processors[at], *copy.mesh));
    if (i > 0) {
      take_fault_of_copy(copy, i + 1, result);
      continue;
    }
    result.status = copy.status;
    result.reason = copy.reason;
    result.process = copy.process;
    result.mesh = copy.mesh;
  }
  if (entries.size() == outcomes.size()) result.side_by_side = entries;
  result.counters[kPerfEvent] = Unavailable{"the kernel counts concurrent processes together"};
}

}  // namespace podm::bench
