#include "trials/verification.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "options/option_keys.h"
#include "process/ask.h"
#include "rows/codec.h"

namespace podm::bench {
namespace {

constexpr double kLinesDelta = 1.25;  // podm's sampling distance of lines, times delta
constexpr const char* kLinesReportName = "/lines.json";
constexpr int kExitDiffers = 1;  // exit code of podm replay

// The parts of podm-verify's report that are read.
struct HistogramReport {
  std::string name;
  std::optional<double> minimum, maximum;  // unset if not finite
  std::vector<std::uint64_t> counts;
  static constexpr auto fields() { return PODM_FIELDS(HistogramReport, name, minimum, maximum, counts); }
};
struct ImageTopologyReport {  // integers of either sign
  double components_6 = 0, components_26 = 0, euler_6 = 0, euler_26 = 0;
  static constexpr auto fields() {
    return PODM_FIELDS(ImageTopologyReport, components_6, components_26, euler_6, euler_26);
  }
};
struct LabelReport {
  std::optional<double> components, euler;
  std::optional<ImageTopologyReport> image;
  static constexpr auto fields() { return PODM_FIELDS(LabelReport, (components), (euler), (image)); }
};
// The details of single claims.
struct SurfaceDetails {
  std::optional<std::vector<LabelReport>> labels;
  static constexpr auto fields() { return PODM_FIELDS(SurfaceDetails, (labels)); }
};
struct BoxDetails {
  double most_ulps_off = 0;
  static constexpr auto fields() { return PODM_FIELDS(BoxDetails, most_ulps_off); }
};
struct DistancesReport {
  double max_mm = 0;
  static constexpr auto fields() { return PODM_FIELDS(DistancesReport, max_mm); }
};
struct FidelityDetails {
  DistancesReport mesh_to_image;
  static constexpr auto fields() { return PODM_FIELDS(FidelityDetails, mesh_to_image); }
};
struct ClaimReport {
  Proof verdict = Proof::kNotRun;
  std::optional<std::vector<HistogramReport>> histograms;
  JsonPointer details;
  static constexpr auto fields() { return PODM_FIELDS(ClaimReport, verdict, (histograms), (details)); }
};
struct VerifierReport {
  ByName<ClaimReport> claims;
  static constexpr auto fields() { return PODM_FIELDS(VerifierReport, claims); }
};

// Returns nothing if it is not a complete record.
template <class Record>
std::optional<Record> whole(const Json& json) {
  try {
    return from_json<Record>(json);
  } catch (const FieldError&) {
    return {};
  }
}

std::optional<VerifierReport> report_of(const Json& json) { return whole<VerifierReport>(json); }

// Returns nothing if the claim was not judged.
template <class Details>
std::optional<Details> details_of(const VerifierReport& report, const char* claim) {
  const ClaimReport* const found = report.claims.find(claim);
  return found != nullptr && found->details ? whole<Details>(*found->details) : std::nullopt;
}

std::optional<VerifierReport> read_report(const std::string& path) {
  std::ifstream file(path);
  return report_of(Json::parse(file, nullptr, false));
}

ByName<Proof> verdicts_of(const VerifierReport& report) {
  ByName<Proof> verdicts;
  for (const auto& [claim, result] : report.claims) verdicts[claim] = result.verdict;
  return verdicts;
}

// Returns the angles of any claim that examines the cells' shapes. All such claims count alike.
std::optional<DihedralRecord> dihedral_angles_of(const VerifierReport& report) {
  for (const auto& [claim, result] : report.claims)
    for (const HistogramReport& histogram : result.histograms.value_or(std::vector<HistogramReport>()))
      if (histogram.name == "dihedral_angle" && histogram.minimum && histogram.maximum)
        return DihedralRecord{*histogram.minimum, *histogram.maximum, histogram.counts};
  return {};
}

bool is_between(double value, double one, double other) {
  return std::min(one, other) <= value && value <= std::max(one, other);
}

// The claim `surface` counts components and Euler numbers of the mesh and, if it has one, of the image.
std::optional<TopologyRecord> topology_of(const VerifierReport& report) {
  const auto surface = details_of<SurfaceDetails>(report, "surface");
  if (!surface || !surface->labels) return {};
  TopologyRecord topology;
  for (const LabelReport& label : *surface->labels) {
    if (!label.components || !label.euler || !label.image) return {};
    const ImageTopologyReport& image = *label.image;
    ++topology.labels;
    topology.components_as_image += is_between(*label.components, image.components_6, image.components_26);
    topology.euler_as_image += is_between(*label.euler, image.euler_6, image.euler_26);
  }
  return topology;
}

// The claim takes about ten seconds of processor time per mesh of a phantom, which is too much for
// kick-tires.
bool asks_fidelity(const Trial& trial) {
  const bool is_of_podm = trial.options.value(kMesher, kPodm) == kPodm;
  return trial.options.value(kFidelity, is_of_podm && trial.tier != Tier::kKickTires);
}

// Measures lines by a run of its own: a mesh that keeps no lines is judged by other bounds of angles.
std::optional<LineDistancesRecord> line_distances_of(const std::string& verifier,
                                                     const std::string& mesh_path, const std::string& image,
                                                     const MeshRecord& record, const std::string& folder,
                                                     double timeout_s, const StopQuery& stop_requested) {
  if (!record.used || !record.used->delta_mm) return {};
  const std::string report_path = folder + kLinesReportName;
  ask({verifier, mesh_path, "--image", image, "--claims", "lines", "--lines-delta",
       fmt::format("{}", kLinesDelta * *record.used->delta_mm), "--json", report_path, "--quiet"},
      timeout_s, stop_requested);
  const auto report = read_report(report_path);
  return report ? details_of<LineDistancesRecord>(*report, "lines") : std::nullopt;
}

// The claims that the record promises and that are not proved. It promises all unless it names them.
std::string fault_of(const ByName<Proof>& verdicts, const MeshRecord& record) {
  const auto is_promised = [&](const std::string& claim) {
    return !record.promises || std::ranges::count(*record.promises, claim) > 0;
  };
  std::string text;
  for (const auto& [claim, verdict] : verdicts)
    if (verdict != Proof::kPass && is_promised(claim))
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", claim, to_string(verdict));
  return text;
}

}  // namespace

std::optional<ByName<Proof>> verdicts_of_report(const Json& json) {
  const auto report = report_of(json);
  return report ? std::optional(verdicts_of(*report)) : std::nullopt;
}

// A proof may take longer than the mesh, and the proof of a large mesh as long as the mesh may take.
double timeout_of_proof_s(const Trial& trial) { return std::max(600.0, trial.timeout_s); }

Verification verify_mesh(const Trial& trial, const std::string& image, const MeshRecord& record,
                         const std::string& mesh_path, const std::string& verifier, const std::string& folder,
                         const StopQuery& stop_requested) {
  const std::string report_path = folder + kReportName;
  std::vector<std::string> command{verifier, mesh_path, "--image", image, "--json", report_path, "--quiet"};
  const auto add = [&command](const std::string& option, const std::string& value) {
    command.insert(command.end(), {option, value});
  };
  JudgingRecord judging = record.verify.value_or(JudgingRecord{});
  if (asks_fidelity(trial)) judging.claims.push_back("fidelity");
  if (!judging.claims.empty()) add("--claims", fmt::format("{}", fmt::join(judging.claims, ",")));
  command.insert(command.end(), judging.options.begin(), judging.options.end());
  if (trial.options.value(kSchedule, false)) add("--schedule", folder + kScheduleName);
  const ProcessOutcome outcome = ask(command, timeout_of_proof_s(trial), stop_requested).outcome;
  const auto report = read_report(report_path);
  Verification verification;
  verification.is_interrupted = outcome.end == ProcessOutcome::End::kInterrupted;
  if (!report) {
    verification.fault = "not verified: " + outcome.describe();
    return verification;
  }
  verification.verdicts = verdicts_of(*report);
  verification.dihedral_deg = dihedral_angles_of(*report);
  verification.topology = topology_of(*report);
  if (const auto box = details_of<BoxDetails>(*report, "box")) verification.box_ulps_off = box->most_ulps_off;
  if (const auto fidelity = details_of<FidelityDetails>(*report, "fidelity"))
    verification.interface_distance_mm = fidelity->mesh_to_image.max_mm;
  if (trial.options.value(kLineDistances, false))
    verification.line_distances = line_distances_of(verifier, mesh_path, image, record, folder,
                                                    timeout_of_proof_s(trial), stop_requested);
  verification.fault = fault_of(verification.verdicts, record);
  return verification;
}

ReplayAttempt replay_mesh(const Trial& trial, const std::string& image, const std::string& podm,
                          const std::string& folder, const StopQuery& stop_requested) {
  using End = ProcessOutcome::End;
  const Reply reply =
      ask({podm, "replay", image, folder + kLogName}, timeout_of_proof_s(trial), stop_requested);
  if (reply.succeeded()) return {{Replay::End::kEqual, ""}};
  if (reply.outcome.end == End::kExited && reply.outcome.exit_code == kExitDiffers)
    return {{Replay::End::kDiffers, ""}};
  return {{Replay::End::kFailed, reply.failure_text()}, reply.outcome.end == End::kInterrupted};
}

}  // namespace podm::bench
