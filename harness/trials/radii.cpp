#include "trials/radii.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <fstream>

#include "experiments/option_matrix.h"
#include "machine/machine.h"
#include "rows/record.h"
#include "rows/results_file.h"
#include "trials/input_files.h"
#include "trials/sha256.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

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
                                      folder + "/record.jsonl", std::string("--quiet")})
    request.arguments.push_back(argument);
  return request;
}

// Of a run that went to its end. A guarantee that it misses is the trial's to tell.
bool tells_radius(const Json& record) {
  return record.is_object() && text_in(record, "stop_reason") == "complete" && number_in(record, "cells") &&
         number_in(record.value("used", Json()), "radius_mm") &&
         number_in(record.value("used", Json()), "delta_mm");
}

// What the mesher tells of finding the radius; null of one that does not.
Json calibration_of(const Json& record) { return record.value("calibration", Json()); }

// All meshes made, the last among them; null where the mesher does not tell.
Json num_meshes(const Json& calibration) {
  if (!calibration.is_object() || !calibration.value("meshes", Json()).is_array()) return nullptr;
  return calibration["meshes"].size() + 1;
}

Json as_in_rows(const Json& line) {
  Json resolved;
  for (const char* key : {kTargetElements, "radius_mm", "delta_mm", "cells", "meshes", "seconds", "key"})
    resolved[key] = line.value(key, Json());
  return resolved;
}

}  // namespace

Radii::Radii(std::string podm, std::string podm_sha256, std::string path)
    : podm_(std::move(podm)), podm_sha256_(std::move(podm_sha256)), path_(std::move(path)) {
  std::ifstream file(path_);
  for (std::string text; std::getline(file, text);)
    if (Json line = Json::parse(text, nullptr, false); line.is_object() && text_in(line, "schema") == kSchema)
      lines_.push_back(std::move(line));
}

std::string Radii::key_of(const Trial& trial, const std::string& image_sha256) const {
  const Json identity = {{"mesher", podm_sha256_},
                         {"input", image_sha256},
                         {kTargetElements, trial.options[kTargetElements]},
                         {"delta_mm", trial.options.value("delta_mm", Json())}};
  return sha256_of(identity.dump());
}

Json Radii::find(const Trial& trial, const std::string& image_sha256) const {
  const std::string key = key_of(trial, image_sha256);
  for (const Json& line : lines_)
    if (text_in(line, "key") == key) return as_in_rows(line);
  return nullptr;
}

Json Radii::resolve(const Trial& trial, const std::string& image, const std::string& image_sha256,
                    const std::string& scratch_folder, const StopQuery& stop_requested) {
  const ProcessRequest request = request_of(trial, podm_, image, scratch_folder);
  const ProcessOutcome outcome = run_process(request, stop_requested);
  std::ifstream file(scratch_folder + "/record.jsonl");
  const Json record = file ? Json::parse(file, nullptr, false) : Json();
  if (outcome.end != ProcessOutcome::End::kExited || !tells_radius(record))
    throw PreparationError(fmt::format("no radius for {} cells", trial.options[kTargetElements].dump()),
                           request.arguments, outcome, read_tail(request.stderr_path, kTailBytes));
  const Json calibration = calibration_of(record);
  store({{"schema", kSchema},
         {"key", key_of(trial, image_sha256)},
         {"input", {{"name", trial.image}, {"path", image}, {"sha256", image_sha256}}},
         {kTargetElements, trial.options[kTargetElements]},
         {"delta_asked_mm", trial.options.value("delta_mm", Json())},
         {"radius_mm", record["used"]["radius_mm"]},
         {"delta_mm", record["used"]["delta_mm"]},
         {"cells", record["cells"]},
         {"meshes", num_meshes(calibration)},
         {"seconds", outcome.wall_s},
         {"calibration", calibration},
         {"warnings", record.value("warnings", Json::array())},
         {"command", request.arguments},
         {"mesher", {{"sha256", podm_sha256_}, {"version", text_in(record, "program")}}},
         {"date", now()}});
  return as_in_rows(lines_.back());
}

// The file is written whole: a crash leaves no half line in it.
void Radii::store(Json line) {
  lines_.push_back(std::move(line));
  std::string text;
  for (const Json& each : lines_) text += each.dump() + "\n";
  write_file(path_, text);
}

}  // namespace podm::bench
