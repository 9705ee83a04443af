#include "trials/radii.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <fstream>

#include "machine/machine.h"
#include "options/option_matrix.h"
#include "process/sha256.h"
#include "process/usable_processors.h"
#include "rows/codec.h"
#include "rows/results_file.h"
#include "trials/input_files.h"

namespace podm::bench {
namespace {

constexpr const char* kSchema = "podm-bench-radius/1";
constexpr std::size_t kTailBytes = 2000;

std::string now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
}

ProcessRequest request_of(const Trial& trial, const std::string& podm, const std::string& image,
                          const std::string& folder) {
  Json options = {{kTargetElements, trial.options[kTargetElements]}, {"threads", usable_processors()}};
  if (trial.options.contains("delta_mm")) options["delta_mm"] = trial.options["delta_mm"];
  ProcessRequest request{.arguments = {podm, "mesh", image},
                         .stdout_path = {},
                         .stderr_path = folder + "/stderr.txt",
                         .timeout_s = trial.timeout_s,
                         .memory_limit_bytes = trial.memory_limit_bytes()};
  const auto arguments = mesher_arguments(options);
  request.arguments.insert(request.arguments.end(), arguments.begin(), arguments.end());
  for (const std::string& argument : {std::string("-o"), folder + "/mesh.vtu", std::string("--record"),
                                      folder + kRecordName, std::string("--quiet")})
    request.arguments.push_back(argument);
  return request;
}

// The record of a run that finds a radius.
struct RadiusRecord {
  std::string stop_reason;
  std::uint64_t cells = 0;
  UsedSizes used;
  std::optional<std::string> program;
  JsonPointer calibration, warnings;
  static constexpr auto fields() {
    return PODM_FIELDS(RadiusRecord, stop_reason, cells, used, (program), (calibration), (warnings));
  }
};

// Returns the record of a complete run; nothing for another run. Missed guarantees are not judged here; the
// trial reports them.
std::optional<RadiusRecord> read_record(const std::string& path) {
  try {
    std::ifstream file(path);
    auto record = from_json<RadiusRecord>(Json::parse(file, nullptr, false));
    const bool is_complete = record.stop_reason == kComplete && record.used.radius_mm && record.used.delta_mm;
    return is_complete ? std::optional(std::move(record)) : std::nullopt;
  } catch (const FieldError&) {
    return {};
  }
}

// Returns the number of all meshes made, including the last; nothing if the mesher does not report them.
std::optional<std::uint64_t> num_meshes(const JsonPointer& calibration) {
  if (!calibration || !calibration->is_object()) return {};
  const Json before_last = calibration->value("meshes", Json());
  return before_last.is_array() ? std::optional(before_last.size() + 1) : std::nullopt;
}

std::optional<RadiusLine> line_of(const std::string& text) {
  try {
    auto line = from_json<RadiusLine>(Json::parse(text, nullptr, false));
    return line.schema == kSchema ? std::optional(std::move(line)) : std::nullopt;
  } catch (const FieldError&) {
    return {};
  }
}

std::optional<double> delta_asked(const Trial& trial) {
  const Json delta = trial.options.value("delta_mm", Json());
  return delta.is_number() ? std::optional(delta.get<double>()) : std::nullopt;
}

}  // namespace

Radii::Radii(std::string podm, std::string podm_sha256, std::string path)
    : podm_(std::move(podm)), podm_sha256_(std::move(podm_sha256)), path_(std::move(path)) {
  std::ifstream file(path_);
  for (std::string text; std::getline(file, text);)
    if (auto line = line_of(text)) lines_.push_back(std::move(*line));
}

std::string Radii::key_of(const Trial& trial, const std::string& image_sha256) const {
  const Json identity = {{"mesher", podm_sha256_},
                         {"input", image_sha256},
                         {kTargetElements, trial.options[kTargetElements]},
                         {"delta_mm", trial.options.value("delta_mm", Json())}};
  return sha256_of(identity.dump());
}

std::optional<ResolvedRadius> Radii::find(const Trial& trial, const std::string& image_sha256) const {
  const std::string key = key_of(trial, image_sha256);
  for (const RadiusLine& line : lines_)
    if (line.key == key) return line;
  return {};
}

ResolvedRadius Radii::resolve(const Trial& trial, const std::string& image, const std::string& image_sha256,
                              const std::string& scratch_folder, const StopQuery& stop_requested) {
  const ProcessRequest request = request_of(trial, podm_, image, scratch_folder);
  const ProcessOutcome outcome = run_process(request, stop_requested);
  const auto record = read_record(scratch_folder + kRecordName);
  if (outcome.end != ProcessOutcome::End::kExited || !record)
    throw PreparationError(fmt::format("no radius for {} cells", trial.options[kTargetElements].dump()),
                           request.arguments, outcome, read_tail(request.stderr_path, kTailBytes));
  const auto no_warnings = std::make_shared<const Json>(Json::array());
  store({{trial.options[kTargetElements], *record->used.radius_mm, *record->used.delta_mm, record->cells,
          num_meshes(record->calibration), outcome.wall_s, key_of(trial, image_sha256)},
         kSchema,
         {trial.image, image, image_sha256},
         delta_asked(trial),
         record->calibration,
         record->warnings ? record->warnings : no_warnings,
         request.arguments,
         {podm_sha256_, record->program.value_or(""), {}},
         now()});
  return lines_.back();
}

// Writes the whole file at once. A crash then leaves no partial line.
void Radii::store(RadiusLine line) {
  lines_.push_back(std::move(line));
  std::string text;
  for (const RadiusLine& each : lines_) text += to_json(each).dump() + "\n";
  write_file(path_, text);
}

}  // namespace podm::bench
