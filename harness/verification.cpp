#include "verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "mesher_options.h"
#include "process.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kClaims = "structure,radius_edge,boundary_angles,delaunay,conformity,surface,labels";
constexpr double kTimeoutS = 600;

Json read_json(const std::string& path) {
  std::ifstream file(path);
  return file ? Json::parse(file, nullptr, false) : Json();
}

// Of the claims that the record promises: all, unless it names them.
std::string fault_of(const Json& verdicts, const Json& record) {
  const auto is_promised = [&](const std::string& claim) {
    const auto promises = record.find("promises");
    return promises == record.end() ||
           std::find(promises->begin(), promises->end(), claim) != promises->end();
  };
  std::string text;
  for (const auto& [claim, verdict] : verdicts.items())
    if (verdict != "pass" && is_promised(claim))
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", claim, verdict.get<std::string>());
  return text;
}

}  // namespace

std::string image_file(const Trial& trial, const Json& image_size, const std::string& podm,
                       const std::string& folder) {
  if (!is_phantom(trial.image)) return trial.image;
  const std::string phantom = trial.image.substr(trial.image.find(':') + 1);
  int longest = 0;
  for (const auto& voxels : image_size) longest = std::max(longest, voxels.get<int>());
  const std::string path = folder + "/image.nii.gz";
  if (std::filesystem::exists(path)) return path;
  const ProcessRequest request{.arguments = {podm, "phantom", phantom.substr(0, phantom.find('@')), "--size",
                                             std::to_string(longest), "-o", path},
                               .stdout_path = {},
                               .stderr_path = {},
                               .timeout_s = kTimeoutS};
  return run_process(request).succeeded() ? path : "";
}

Verification verify_mesh(const Trial& trial, const Json& image_size, const Json& record,
                         const std::string& mesh_path, const Programs& programs, const std::string& folder,
                         const StopQuery& stop_requested) {
  const std::string image = image_file(trial, image_size, programs.podm, folder);
  if (image.empty()) return {Json::object(), "not verified: the phantom was not written", false};
  const std::string report_path = folder + "/verification.json";
  std::vector<std::string> command{programs.verifier, mesh_path,   "--image", image,
                                   "--json",          report_path, "--quiet", "--claims"};
  const double radius_mm = record.value("used", Json::object()).value("radius_mm", 0.0);
  command.push_back(radius_mm > 0 ? std::string(kClaims) + ",size" : kClaims);
  if (radius_mm > 0) command.insert(command.end(), {"--radius", fmt::format("{}", radius_mm)});
  if (trial.options.value(kSchedule, false))
    command.insert(command.end(), {"--schedule", folder + kScheduleName});
  const ProcessOutcome outcome = run_process(
      {.arguments = command, .stdout_path = {}, .stderr_path = {}, .timeout_s = kTimeoutS}, stop_requested);
  const Json report = read_json(report_path);
  Verification verification{Json::object(), {}, outcome.end == ProcessOutcome::End::kInterrupted};
  if (!report.is_object()) {
    verification.fault = "not verified: " + outcome.describe();
    return verification;
  }
  const Json claims = report.value("claims", Json::object());
  for (const auto& [claim, result] : claims.items()) verification.verdicts[claim] = result["verdict"];
  verification.fault = fault_of(verification.verdicts, record);
  return verification;
}

}  // namespace podm::bench
