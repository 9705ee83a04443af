#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rows/results_file.h"
#include "submissions/archive.h"
#include "submissions/commands.h"
#include "submissions/rules.h"
#include "submissions/submission.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRadii = "radii";  // its lines are no rows

// Returns the names of experiments that have rows.
std::vector<std::string> experiments_with_rows(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".jsonl" && entry.path().stem() != kRadii)
      names.push_back(entry.path().stem().string());
  if (error) throw InputError(fmt::format("cannot read {}: {}", folder, error.message()));
  if (names.empty()) throw InputError(fmt::format("{}: no rows in this folder", folder));
  std::ranges::sort(names);
  return names;
}

std::string text_of(const std::string& path) {
  if (path.empty()) return "";
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError(fmt::format("cannot read {}", path));
  return text.str();
}

Division parse_division(const std::string& text) {
  for (const Division division : {Division::kClosed, Division::kOpen})
    if (text == to_string(division)) return division;
  throw InputError(fmt::format("unknown division '{}'; known: closed, open", text));
}

}  // namespace

int pack_submission(const PackCommand& command) {
  std::vector<std::string> names;
  for (const std::string& experiment : command.experiments)
    names.push_back(fs::path(experiment).stem().string());
  if (names.empty()) names = experiments_with_rows(command.results_folder);
  Manifest manifest;
  manifest.division = parse_division(command.division);
  manifest.submitter = command.submitter;
  manifest.declaration = text_of(command.declaration_path);
  manifest.date = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
  manifest.podm_bench = PODM_VERSION;
  const PackedFiles files = submission_files(command.results_folder, names, manifest);
  Faults faults;
  const Submission submission = read_submission(files, command.output, faults);
  check_rules(submission, experiments_in(command.experiments_folder), faults);
  if (!faults.empty()) {
    fmt::print(stderr, "{} is not written:\n{}", command.output, describe(faults));
    return kExitMissed;
  }
  write_file(command.output, pack(files));
  fmt::print(stderr, "{}: {}\n", command.output, describe(submission));
  return 0;
}

}  // namespace podm::bench
