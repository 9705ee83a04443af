#include "submissions/submission.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include "options/option_keys.h"
#include "process/sha256.h"
#include "rows/codec.h"
#include "rows/results_file.h"
#include "rows/row_filter.h"
#include "submissions/parse.h"
#include "trials/trial_logs.h"

namespace podm::bench {
namespace {

constexpr const char *kRows = "rows/", *kLogs = "logs/", *kTopology = "topology-";

std::optional<std::string> text_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string name_of_topology(const Row& row) {
  return fmt::format("{}{}.xml", kTopology, row.environment.topology_sha256);
}

void add_topology(const std::string& results_folder, const Row& row, PackedFiles& files) {
  if (row.environment.topology_sha256.starts_with(Unavailable::kPrefix)) return;
  const std::string name = name_of_topology(row);
  if (files.contains(name)) return;
  const auto text = text_of_file(fmt::format("{}/{}", results_folder, name));
  if (!text) throw InputError(fmt::format("{}/{}: no such file; rows name it", results_folder, name));
  files[name] = *text;
}

void add_logs(const std::string& results_folder, const Row& row, PackedFiles& files) {
  for (const char* name : kLogNames)
    if (const auto text = text_of_file(logs_folder(results_folder, row.key) + name))
      files[fmt::format("{}{}{}", kLogs, row.key, name)] = *text;
}

std::string name_of_rows(const std::string& experiment) {
  return fmt::format("{}{}.jsonl", kRows, experiment);
}

void read_rows_of(const std::string& name, const std::string& text, Submission& submission, Faults& faults) {
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = fmt::format("{}:{}", name, ++number);
    const Json json = parse_untrusted(line);
    const Json schema = json.is_object() ? json.value("schema", Json()) : Json();
    if (schema != kRowSchema) {
      faults.push_back({"schema", fmt::format("{}: not a row of schema {}", place, kRowSchema)});
      continue;
    }
    try {
      submission.rows.push_back({from_json<Row>(json), std::make_shared<const Json>(json), {}});
      if (const std::string& experiment = submission.rows.back().row.experiment;
          name != name_of_rows(experiment))
        faults.push_back({"schema", fmt::format("{}: a row of the experiment '{}'", place, experiment)});
    } catch (const FieldError& fault) {
      faults.push_back({"schema", fmt::format("{}: {}", place, fault.what())});
    }
  }
}

// The hashes of the manifest name exactly the other files.
void check_hashes(const PackedFiles& files, const Manifest& manifest, Faults& faults) {
  for (const auto& [name, text] : files) {
    const std::string* const hash = manifest.files.find(name);
    if (name == kManifestName) continue;
    if (hash == nullptr)
      faults.push_back({"files", fmt::format("{}: the manifest does not list it", name)});
    else if (*hash != sha256_of(text))
      faults.push_back({"files", fmt::format("{}: its hash is not that of the manifest", name)});
  }
  for (const auto& [name, hash] : manifest.files)
    if (!files.contains(name))
      faults.push_back({"files", fmt::format("{}: missing, although the manifest lists it", name)});
}

Manifest read_manifest(const PackedFiles& files, const std::string& path) {
  const auto found = files.find(kManifestName);
  if (found == files.end())
    throw InputError(fmt::format("{}: not a submission: it has no {}", path, kManifestName));
  try {
    const auto manifest = from_json<Manifest>(parse_untrusted(found->second));
    if (manifest.schema == kManifestSchema) return manifest;
    throw FieldError(fmt::format("schema '{}'; this program reads {}", manifest.schema, kManifestSchema));
  } catch (const FieldError& fault) {
    throw InputError(fmt::format("{}: {}: {}", path, kManifestName, fault.what()));
  }
}

}  // namespace

bool is_repeatable(const Row& row) {
  const Json& asked = asked_of(row);
  return !asked.contains(kRanks) &&
         (asked.value("threads", 1) == 1 || asked.value("executor", "threads") == "virtual");
}

PackedFiles submission_files(const std::string& results_folder, const std::vector<std::string>& experiments,
                             Manifest manifest) {
  PackedFiles files;
  for (const std::string& experiment : experiments) {
    const std::vector<Row> rows =
        rows_to_judge(read_rows(fmt::format("{}/{}.jsonl", results_folder, experiment)).rows);
    if (rows.empty())
      throw InputError(fmt::format("{}/{}.jsonl: no row that counts", results_folder, experiment));
    std::string& lines = files[name_of_rows(experiment)];
    for (const Row& row : rows) {
      lines += as_line(row);
      add_topology(results_folder, row, files);
      add_logs(results_folder, row, files);
    }
  }
  for (const auto& [name, text] : files) manifest.files[name] = sha256_of(text);
  files[kManifestName] = to_json(manifest).dump(1) + "\n";
  return files;
}

Submission read_submission(const PackedFiles& files, const std::string& path, Faults& faults) {
  Submission submission;
  submission.manifest = read_manifest(files, path);
  check_hashes(files, submission.manifest, faults);
  for (const auto& [name, text] : files)
    if (name.starts_with(kRows)) read_rows_of(name, text, submission, faults);
  std::set<std::string> known{kManifestName};
  for (SubmittedRow& each : submission.rows) {
    known.insert(name_of_topology(each.row));
    for (const char* log : kLogNames) {
      const auto found = files.find(fmt::format("{}{}{}", kLogs, each.row.key, log));
      if (found == files.end()) continue;
      each.logs[log] = found->second;
      known.insert(found->first);
    }
  }
  for (const auto& [name, text] : files) {
    if (name.starts_with(kTopology)) submission.topologies.push_back(sha256_of(text));
    if (!name.starts_with(kRows) && !known.contains(name))
      faults.push_back({"files", fmt::format("{}: no row needs it", name)});
  }
  return submission;
}

}  // namespace podm::bench
