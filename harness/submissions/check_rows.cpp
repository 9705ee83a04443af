// Keys, programs, status, hashes and machines of the rows.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "options/option_keys.h"
#include "rows/codec.h"
#include "rows/machine_state.h"
#include "rows/row_filter.h"
#include "submissions/checks.h"
#include "trials/peer.h"
#include "trials/record.h"
#include "trials/trial_key.h"

namespace podm::bench {
namespace {

constexpr std::size_t kHashDigits = 64;

bool is_hash(const std::string& text) {
  return text.size() == kHashDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string mesher_of(const Row& row) {
  if (row.asked && row.asked->contains(kMeasure)) return "none";
  if (row.programs.peer) return row.programs.peer->sha256;
  return row.programs.podm_mpi ? row.programs.podm_mpi->sha256 : row.programs.podm.sha256;
}

// A row on a described machine does not have the hash of the file that its key has.
bool has_known_parts(const Row& row) { return !asked_of(row).contains("topology"); }

// Returns the build's line, e.g. "dirty"; empty if the program does not report it.
std::string line_of(const ProgramRecord& program, const std::string& key) {
  if (!program.build) return "";
  const auto* const lines = std::get_if<ByName<std::string>>(&*program.build);
  const std::string* const line = lines == nullptr ? nullptr : lines->find(key);
  return line == nullptr ? "" : *line;
}

void check_program(const Row& row, const char* name, const ProgramRecord& program, Faults& faults) {
  if (!is_hash(program.sha256))
    faults.push_back({"programs", fmt::format("{}: {} has no hash", name_of(row), name)});
  if (line_of(program, "dirty") != "false")
    faults.push_back({"programs", fmt::format("{}: {} is not of clean sources: dirty is '{}'", name_of(row),
                                              name, line_of(program, "dirty"))});
}

// Names the mesh that a row of one thread, or of virtual time, makes to the bit.
std::string repeated_part(const Row& row) {
  Json options = asked_of(row);
  for (const char* key : {kReplay, kFidelity, kLineDistances, kSolve, kSchedule, kCounters, kCopies})
    options.erase(key);
  return Json({mesher_of(row), row.input.sha256.value_or(""), options, to_json(row.resolved)}).dump();
}

// podm promises what it has podm-verify judge; another mesher may name the claims that it promises.
bool is_promised(const Row& row, const std::string& claim) {
  const MeshRecord& mesh = *row.mesh;
  if (mesh.verify && !row.programs.peer && std::ranges::count(mesh.verify->claims, claim) > 0) return true;
  return !mesh.promises || std::ranges::count(*mesh.promises, claim) > 0;
}

std::string fault_of_mesh(const Row& row) {
  const MeshRecord& mesh = *row.mesh;
  for (const auto& [guarantee, misses] : mesh.guarantees)
    if (misses != 0) return fmt::format("{} misses of {}", misses, guarantee);
  if (!mesh.verdicts || mesh.verdicts->empty()) return "no verdict of podm-verify";
  if (mesh.verify && !row.programs.peer)
    for (const std::string& claim : mesh.verify->claims)
      if (mesh.verdicts->find(claim) == nullptr) return "no verdict of podm-verify on " + claim;
  for (const auto& [claim, verdict] : *mesh.verdicts)
    if (verdict != Proof::kPass && is_promised(row, claim))
      return fmt::format("{}: {}", claim, to_string(verdict));
  if (row.replay && row.replay->end != Replay::End::kEqual) return "replay " + row.replay->text();
  return mesh.stop_reason == kComplete ? "" : "stopped: " + mesh.stop_reason;
}

}  // namespace

void check_keys(const Submission& submission, Faults& faults) {
  std::set<std::string> keys;
  for (const auto& [row, line, logs] : submission.rows) {
    if (!keys.insert(row.key).second)
      faults.push_back({"keys", fmt::format("{}: a second row of key {}", name_of(row), row.key)});
    if (!has_known_parts(row)) continue;
    const std::string key = key_of({.mesher = mesher_of(row),
                                    .input = row.input.sha256.value_or(""),
                                    .trial = row.trial,
                                    .options = with_radius(asked_of(row), row.resolved),
                                    .machine = row.environment,
                                    .repeat = row.repeat,
                                    .is_warmup = row.warmup});
    if (key != row.key)
      faults.push_back(
          {"keys",
           fmt::format("{}: its key is not that of its mesher, input, options and machine", name_of(row))});
  }
}

void check_programs(const Submission& submission, Faults& faults) {
  for (const auto& [row, line, logs] : submission.rows) {
    check_program(row, "podm", row.programs.podm, faults);
    if (const auto* const verifier = std::get_if<ProgramRecord>(&row.programs.podm_verify))
      check_program(row, "podm-verify", *verifier, faults);
    else
      faults.push_back({"programs", fmt::format("{}: no podm-verify judged it", name_of(row))});
    if (row.programs.podm_mpi) check_program(row, "podm-mpi", *row.programs.podm_mpi, faults);
    if (row.programs.peer && !is_hash(row.programs.peer->sha256))
      faults.push_back(
          {"programs", fmt::format("{}: {} has no hash", name_of(row), row.programs.peer->name)});
    const auto* const sources = std::get_if<Sources>(&row.environment.sources);
    if (sources != nullptr && sources->dirty)
      faults.push_back({"programs", fmt::format("{}: podm-bench is not of clean sources", name_of(row))});
  }
}

void check_status(const Submission& submission, Faults& faults) {
  for (const auto& [row, line, logs] : submission.rows) {
    if (row.status == Status::kOk && !row.mesh && !row.measured)
      faults.push_back({"status", fmt::format("{}: ok without a mesh", name_of(row))});
    if (row.status == Status::kInterrupted)
      faults.push_back({"status", fmt::format("{}: the user interrupted it", name_of(row))});
    if (basis_of(asked_of(row), row.process.counters) != row.basis)
      faults.push_back({"status", fmt::format("{}: its options do not give '{}' values", name_of(row),
                                              to_string(row.basis))});
    if (!row.mesh) continue;
    const std::string fault = fault_of_mesh(row);
    if (row.status == Status::kOk && !fault.empty())
      faults.push_back({"status", fmt::format("{}: ok in spite of {}", name_of(row), fault)});
  }
}

void check_hashes_of_rows(const Submission& submission, Faults& faults) {
  std::map<std::string, std::string> inputs, meshes;
  for (const auto& [row, line, logs] : submission.rows) {
    if (!row.mesh) continue;
    const std::string input = row.input.sha256.value_or("");
    if (!is_hash(input))
      faults.push_back({"hashes", fmt::format("{}: its input has no hash", name_of(row))});
    else if (inputs.emplace(row.input.name, input).first->second != input)
      faults.push_back({"hashes", fmt::format("{}: input {} has another hash in another row", name_of(row),
                                              row.input.name)});
    const std::string mesh = row.mesh->mesh_sha256.value_or("");
    if (!row.programs.peer && !is_hash(mesh))
      faults.push_back({"hashes", fmt::format("{}: its mesh has no hash", name_of(row))});
    if (!mesh.empty() && is_repeatable(row) && meshes.emplace(repeated_part(row), mesh).first->second != mesh)
      faults.push_back(
          {"hashes", fmt::format("{}: another mesh than a row of the same options", name_of(row))});
  }
}

void check_machines(const Submission& submission, Faults& faults) {
  std::map<std::string, const Row*> first;
  for (const auto& [row, line, logs] : submission.rows) {
    if (row.environment.cpu.empty() || row.environment.cpu.starts_with(Unavailable::kPrefix) ||
        !row.environment.identity)
      faults.push_back({"machine", fmt::format("{}: it does not name its machine", name_of(row))});
    const std::string& topology = row.environment.topology_sha256;
    if (is_hash(topology) && std::ranges::count(submission.topologies, topology) == 0)
      faults.push_back({"machine", fmt::format("{}: topology-{}.xml is missing", name_of(row), topology)});
    if (row.basis != Basis::kMeasured) continue;
    const Row& other = *first.emplace(row.experiment, &row).first->second;
    if (!same_machine(row, other))
      faults.push_back({"machine", fmt::format("{}: of another machine than {}; no ratio may compare both",
                                               name_of(row), name_of(other))});
  }
}

}  // namespace podm::bench
