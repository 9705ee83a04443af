#include "trials/record.h"

#include "options/option_keys.h"
#include "trials/counter_tool.h"
#include "trials/ranks.h"

namespace podm::bench {
namespace {

constexpr double kImageBytesPerVoxel = 2;  // a label

ProcessRecord process_of(const Trial& trial, const TrialResult& result) {
  using End = ProcessOutcome::End;
  const ProcessOutcome& process = result.process;
  ProcessRecord record;
  if (process.end == End::kExited) record.exit_code = process.exit_code;
  if (process.end == End::kSignalled) record.signal = process.signal;
  record.timeout_s = trial.timeout_s;
  if (trial.memory_limit_gib > 0) record.memory_limit_gib = trial.memory_limit_gib;
  record.wall_s = process.wall_s;
  record.user_s = process.user_s;
  record.system_s = process.system_s;
  record.peak_rss_bytes = process.peak_rss_bytes;
  record.bytes_per_cell_beyond_image =
      bytes_per_cell_beyond_image(result, is_over_mpi(trial.options) ? num_ranks(trial) : 1);
  record.counters = result.counters;
  return record;
}

// Returns the file as the mesher recorded it. For a peer the harness knows the file.
InputRecord input_of(const Trial& trial, const TrialResult& result) {
  InputRecord input{trial.image, result.preparation.image, result.preparation.sha256, {}, result.image_size};
  if (!result.mesh || !result.mesh->input) return input;
  const InputOfMesher& read = *result.mesh->input;
  if (read.path) input.path = *read.path;
  if (read.sha256) input.sha256 = read.sha256;
  input.affine = read.affine;
  return input;
}

}  // namespace

Basis basis_of(const Json& asked, const Counters& counters) {
  const auto* const counter = counters.find(kCachegrind);
  const bool is_on_simulated_core = asked.value(kCounters, "") == kCachegrind &&
                                    (counter == nullptr || !std::holds_alternative<Unavailable>(*counter));
  const bool is_simulated = asked.value("executor", "threads") != "threads" || asked.contains("topology") ||
                            asked.value(kCarrier, "") == kInProcess || is_on_simulated_core;
  return is_simulated ? Basis::kSimulated : Basis::kMeasured;
}

std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result, int num_processes) {
  if (!result.mesh || !result.image_size || result.mesh->cells == 0) return {};
  double image_bytes = kImageBytesPerVoxel;
  for (const int voxels : *result.image_size) image_bytes *= voxels;
  return (static_cast<double>(result.process.peak_rss_bytes) - image_bytes) * num_processes /
         static_cast<double>(result.mesh->cells);
}

Row make_row(const RowContext& context, const Trial& trial, const Turn& turn, const TrialResult& result) {
  Row row;
  static_cast<TrialOutcome&>(row) = result;
  row.key = context.key;
  row.experiment = context.experiment;
  row.trial = trial.name;
  row.repeat = turn.repeat;
  row.warmup = turn.is_warmup;
  row.order_seed = context.order_seed;
  row.asked = std::make_shared<const Json>(trial.options);
  row.basis = basis_of(trial.options, result.counters);
  row.resolved = result.preparation.resolved;
  row.input = input_of(trial, result);
  if (result.mesh_bytes > 0) row.mesh_bytes = result.mesh_bytes;
  row.process = process_of(trial, result);
  row.harness_s = context.harness_s;
  row.programs = context.programs;
  row.programs.peer = result.peer;
  if (num_ranks(trial) == 0) row.programs.podm_mpi.reset();
  row.environment = context.environment;
  if (row.basis == Basis::kMeasured) row.environment.busy_elsewhere = result.busy_elsewhere;
  return row;
}

}  // namespace podm::bench
