#include "rows/record.h"

#include "rows/measure.h"
#include "trials/counter_tool.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kImageBytesPerVoxel = 2 + 4;  // its label and its feature transform

Json process_of(const Trial& trial, const TrialResult& result) {
  using End = ProcessOutcome::End;
  const ProcessOutcome& process = result.process;
  const auto memory = bytes_per_cell_beyond_image(result);
  return {{"exit_code", process.end == End::kExited ? Json(process.exit_code) : Json()},
          {"signal", process.end == End::kSignalled ? Json(process.signal) : Json()},
          {"timeout_s", trial.timeout_s},
          {"memory_limit_gib", trial.memory_limit_gib > 0 ? Json(trial.memory_limit_gib) : Json()},
          {"wall_s", process.wall_s},
          {"user_s", process.user_s},
          {"system_s", process.system_s},
          {"peak_rss_bytes", process.peak_rss_bytes},
          {"bytes_per_cell_beyond_image", memory ? Json(*memory) : Json()},
          {"counters", result.counters}};
}

// The file as the mesher knows it, a peer as the harness does.
Json input_of(const Trial& trial, const TrialResult& result) {
  Json input = {
      {"name", trial.image}, {"path", result.preparation.image}, {"sha256", result.preparation.sha256}};
  if (result.record.is_object()) input.update(result.record.value("input", Json::object()));
  input["size"] = result.image_size;
  return input;
}

}  // namespace

std::string basis_of(const Json& asked, const Json& counters) {
  const bool is_on_simulated_core =
      asked.value(kCounters, "") == kCachegrind && !counters.value(kCachegrind, Json()).is_string();
  const bool is_simulated =
      asked.value("executor", "threads") != "threads" || asked.contains("topology") || is_on_simulated_core;
  return to_string(is_simulated ? Basis::kSimulated : Basis::kMeasured);
}

std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result) {
  if (!result.record.is_object() || !result.image_size.is_array()) return {};
  const double cells = result.record["cells"];
  if (cells == 0) return {};
  double image_bytes = kImageBytesPerVoxel;
  for (const auto& voxels : result.image_size) image_bytes *= voxels.get<double>();
  return (static_cast<double>(result.process.peak_rss_bytes) - image_bytes) / cells;
}

Json make_row(const RowContext& context, const Trial& trial, const Turn& turn, const TrialResult& result) {
  Json row = {{"schema", kRowSchema},
              {"key", context.key},
              {"experiment", context.experiment},
              {"trial", trial.name},
              {"repeat", turn.repeat},
              {"warmup", turn.is_warmup},
              {"order_seed", context.order_seed},
              {"status", to_string(result.status)},
              {"reason", result.reason},
              {"asked", trial.options},
              {"basis", basis_of(trial.options, result.counters)},
              {"command", result.command},
              {"resolved", result.preparation.resolved},
              {"input", Json()}};
  if (result.record.is_object()) row.update(result.record);
  row["schema"] = kRowSchema;  // the mesher's record has its own
  row["input"] = input_of(trial, result);
  row["replay"] = result.replay;
  row["side_by_side"] = result.side_by_side;
  row["mesh_bytes"] = result.mesh_bytes > 0 ? Json(result.mesh_bytes) : Json();
  row["process"] = process_of(trial, result);
  row["preparation_s"] = result.preparation_s;
  row["verification_s"] = result.verification_s;
  row["harness_s"] = context.harness_s;
  row["stderr_tail"] = result.stderr_tail;
  row["programs"] = context.programs;
  if (!result.peer.is_null()) row["programs"]["peer"] = result.peer;
  row["environment"] = context.environment;
  return row;
}

std::string text_in(const Json& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

std::optional<double> number_in(const Json& row, const char* key) {
  const auto found = row.find(key);
  return found != row.end() && found->is_number() ? std::optional<double>(*found) : std::nullopt;
}

Json at(const Json& row, const std::string& place) { return row.value(Json::json_pointer(place), Json()); }

std::optional<double> number_at(const Json& row, const char* place) {
  const Json value = at(row, place);
  return value.is_number() ? std::optional<double>(value.get<double>()) : std::nullopt;
}

std::optional<double> sum_at(const Json& row, const char* place) {
  const Json parts = at(row, place);
  if (!parts.is_structured()) return {};
  double sum = 0;
  for (const Json& part : parts) sum += part.get<double>();
  return sum;
}

Json machine_of(const Json& row) {
  Json machine = Json::object();
  const Json environment = row.value("environment", Json::object());
  for (const char* key : {"cpu", "packages", "numa_nodes", "cores", "processors", "usable_processors"})
    if (environment.contains(key)) machine[key] = environment[key];
  return machine;
}

bool is_finished(const Json& row) {
  const std::string status = text_in(row, "status");
  return status == to_string(Status::kOk) || status == to_string(Status::kUnmet);
}

}  // namespace podm::bench
