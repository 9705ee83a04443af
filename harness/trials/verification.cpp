#include "trials/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "experiments/option_matrix.h"
#include "trials/ask.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kClaims = "structure,radius_edge,boundary_angles,delaunay,conformity,surface,labels";
constexpr double kTimeoutS = 600;
constexpr int kExitDiffers = 1;  // of podm replay

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

Verification verify_mesh(const Trial& trial, const std::string& image, const Json& record,
                         const std::string& mesh_path, const std::string& verifier, const std::string& folder,
                         const StopQuery& stop_requested) {
  const std::string report_path = folder + "/verification.json";
  std::vector<std::string> command{verifier, mesh_path, "--image", image, "--json", report_path, "--quiet"};
  const auto add = [&command](const std::string& option, const std::string& value) {
    command.insert(command.end(), {option, value});
  };
  const Json used = record.value("used", Json::object());
  const double radius_mm = used.value("radius_mm", 0.0);
  const bool with_fidelity = trial.options.value(kFidelity, false);
  add("--claims",
      fmt::format("{}{}{}", kClaims, radius_mm > 0 ? ",size" : "", with_fidelity ? ",fidelity" : ""));
  if (radius_mm > 0) add("--radius", fmt::format("{}", radius_mm));
  if (with_fidelity) add("--delta", fmt::format("{}", used.value("delta_mm", 0.0)));
  if (trial.options.value(kSchedule, false)) add("--schedule", folder + kScheduleName);
  const ProcessOutcome outcome = ask(command, kTimeoutS, stop_requested).outcome;
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

Replay replay_mesh(const std::string& image, const std::string& podm, const std::string& folder,
                   const StopQuery& stop_requested) {
  using End = ProcessOutcome::End;
  const Reply reply = ask({podm, "replay", image, folder + kLogName}, kTimeoutS, stop_requested);
  if (reply.succeeded()) return {"equal"};
  if (reply.outcome.end == End::kExited && reply.outcome.exit_code == kExitDiffers) return {"differs"};
  return {"failed: " + reply.why_not(), reply.outcome.end == End::kInterrupted};
}

}  // namespace podm::bench
