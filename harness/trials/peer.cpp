#include "trials/peer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "errors.h"
#include "options/option_matrix.h"
#include "process/ask.h"
#include "process/sha256.h"
#include "rows/mesher_record.h"

namespace podm::bench {
namespace {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

Peer ask_for_version(const std::string& program, const std::string& podm) {
  const Reply reply = ask({program, "--version", "--podm", podm});
  const std::string line = first_line(reply.text);
  if (reply.succeeded()) return {program, line, {}};
  return {program, {}, line.empty() ? program + " --version: " + reply.failure_text() : line};
}

// A peer promises what its own documentation says; its rows show which claims of podm-verify its meshes meet.
Json judging_of_peers(double radius_mm) {
  Json claims = {"structure", "radius_edge", "boundary_angles",  "conformity",
                 "surface",   "labels",      "surface_vertices", "delaunay"};
  Json options = Json::array();
  if (radius_mm > 0) {
    claims.push_back("size");
    options = {"--radius", fmt::format("{}", radius_mm)};
  }
  return {{"claims", claims}, {"options", options}};
}

}  // namespace

std::string Peer::sha256() const {
  const auto folder = std::filesystem::path(program).parent_path().parent_path();
  std::vector<std::string> hashes;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".py") hashes.push_back(sha256_of_file(entry.path().string()));
  std::sort(hashes.begin(), hashes.end());
  return sha256_of(fmt::format("{} {} {}", sha256_of_file(program), version, fmt::join(hashes, " ")));
}

bool is_of_peer(const Trial& trial) { return trial.options.value(kMesher, kPodm) != kPodm; }

const Peer& Peers::of(const Trial& trial) {
  const std::string name = trial.options[kMesher];
  if (const auto known = peers_.find(name); known != peers_.end()) return known->second;
  const std::string program = std::filesystem::absolute(fmt::format("{}/{}/run", folder_, name)).string();
  if (folder_.empty() || access(program.c_str(), X_OK) != 0)
    throw InputError(fmt::format("{}: there is no mesher '{}': no program {}", trial.name, name, program));
  return peers_[name] = ask_for_version(program, podm_);
}

std::vector<std::string> peer_command(const Trial& trial, const Preparation& preparation, const Peer& peer,
                                      const std::string& podm, const std::string& folder) {
  std::vector<std::string> command{peer.program,      "--podm",   podm,  "--image",
                                   preparation.image, "--output", folder};
  const std::vector<std::string> options = mesher_arguments(resolved_options(trial, preparation));
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

Json complete_record(const Trial& trial, const Preparation& preparation, Json record) {
  if (!record.is_object()) return record;
  record["schema"] = kMesherSchema;
  record["algorithm"] = trial.options[kMesher];
  record["guarantees"] = Json::object();  // peers promise claims of the verifier instead
  record["stop_reason"] = kComplete;
  const double radius_mm = resolved_options(trial, preparation).value("radius_mm", 0.0);
  record["used"]["radius_mm"] = radius_mm;
  if (const Json delta_mm = resolved_options(trial, preparation).value("delta_mm", Json());
      !delta_mm.is_null())
    record["used"]["delta_mm"] = delta_mm;
  record["verify"] = judging_of_peers(radius_mm);
  const Json phases = record.value("phases_s", Json()), cells = record.value("cells", Json());
  const Json seconds = phases.is_object() ? phases.value("refine", Json()) : Json();
  if (seconds.is_number() && seconds > 0 && cells.is_number())
    record["refine_cells_per_second"] = cells.get<double>() / seconds.get<double>();
  return record;
}

}  // namespace podm::bench
