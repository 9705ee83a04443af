#include "submissions/remesh.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <regex>
#include <set>

#include "options/option_matrix.h"
#include "process/sha256.h"
#include "process/usable_processors.h"
#include "rows/codec.h"
#include "trials/peer.h"
#include "trials/ranks.h"
#include "trials/record.h"
#include "trials/trial.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kShareOfCells = 0.02;  // between runs of several threads
constexpr double kMostSeconds = 3600, kShareOfMemory = 0.75;

// A new folder below the system's folder of temporary files; removed with its files.
class TemporaryResults {
 public:
  TemporaryResults() : path_((fs::temp_directory_path() / "podm-check-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) throw InputError("cannot make the folder " + path_);
    fs::create_directory(path_ + "/trial");
  }
  ~TemporaryResults() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  TemporaryResults(const TemporaryResults&) = delete;
  TemporaryResults& operator=(const TemporaryResults&) = delete;
  const std::string& path() const { return path_; }

  // Returns an empty folder.
  std::string empty_folder() const {
    fs::remove_all(path_ + "/trial");
    fs::create_directory(path_ + "/trial");
    return path_ + "/trial";
  }

 private:
  std::string path_;
};

double memory_limit_gib() {
  const double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return kShareOfMemory * bytes / (1024.0 * 1024 * 1024);
}

// Names of phantoms become names of files.
bool is_plain_phantom(const std::string& image) {
  static const std::regex kPlain("phantom:[a-z]{1,30}(@[0-9]{1,4})?");
  return std::regex_match(image, kPlain);
}

bool passed_fidelity(const Row& row) {
  const Proof* const verdict = row.mesh->verdicts ? row.mesh->verdicts->find(kFidelity) : nullptr;
  return verdict != nullptr && *verdict == Proof::kPass;
}

// Rows of different trials, in an order drawn by the seed.
std::vector<const Row*> drawn_rows(const Submission& submission, std::uint64_t seed) {
  std::vector<const Row*> rows;
  std::set<std::string> trials;
  for (const auto& [row, line, logs] : submission.rows)
    if (row.mesh && is_finished(row) && trials.insert(row.experiment + "/" + row.trial).second)
      rows.push_back(&row);
  std::mt19937_64 random(seed);
  std::ranges::shuffle(rows, random);
  return rows;
}

// Makes one mesh after the other and compares it with its row.
class Remesher {
 public:
  Remesher(const ExperimentsOn& experiments, const RemeshSettings& settings, const StopQuery& stop_requested)
      : experiments_(experiments),
        settings_(settings),
        stop_requested_(stop_requested),
        podm_sha256_(sha256_of_file(settings.programs.podm)),
        preparer_(settings.programs.podm, podm_sha256_, results_.path()),
        runner_(settings.programs) {}

  // Returns a line on the mesh, or sets `absence` to the reason why it cannot be made here.
  std::string make(const Row& row, Division division, std::string& absence, Faults& faults) {
    Trial trial = trial_for(row, division, absence);
    if (absence.empty()) absence = absence_of(row, trial);
    if (!absence.empty()) return "";
    const auto add = [&](const std::string& fault) {
      faults.push_back({"meshed again", fmt::format("{}: {}{}", name_of(row), fault, commits(row))});
    };
    try {
      const Preparation preparation = preparer_.make(
          trial, results_.empty_folder(), [](const auto&) {}, stop_requested_);
      if (preparation.sha256 != row.input.sha256.value_or("")) {
        add(fmt::format("its input {} has the hash {} here, not {}", row.input.name, preparation.sha256,
                        row.input.sha256.value_or("")));
        return "";
      }
      const TrialResult result = runner_.run(trial, preparation, results_.empty_folder(), stop_requested_);
      const std::string fault = difference(row, result);
      if (!fault.empty()) add(fault);
      return fault.empty() ? describe(row, result) : "";
    } catch (const PreparationError& error) {
      add(fmt::format("its input cannot be made: {}", error.what()));
      return "";
    }
  }

 private:
  // The suite's own trial, or for an open submission the row's options if they are harmless.
  Trial trial_for(const Row& row, Division division, std::string& absence) {
    Trial trial;
    const Trial* const own = trial_of(row, experiments_(row.environment.usable_processors));
    if (own != nullptr) trial = *own;
    if (own == nullptr && division == Division::kClosed) absence = "no trial of the experiments";
    if (own == nullptr || row.programs.peer) {
      trial.options = asked_of(row);
      if (const std::string fault = fault_of_options(trial.options); !fault.empty())
        absence = "its options: " + fault;
    }
    if (own == nullptr) trial.image = image_of(row);
    if (trial.image.empty() || !image_exists(trial))
      if (absence.empty()) absence = fmt::format("this machine has no image {}", row.input.name);
    if (!absence.empty()) return trial;
    trial.options = with_radius(trial.options, row.resolved);
    trial.options[kReplay] = !row.programs.peer && !trial.options.value("optimize", false);
    trial.options[kFidelity] = passed_fidelity(row);
    for (const char* key : {kSolve, kCopies, kCounters, kLineDistances}) trial.options.erase(key);
    if (row.programs.peer)
      for (const char* key : {kReplay, kFidelity}) trial.options.erase(key);
    trial.name = row.trial;
    trial.if_exists = false;
    trial.timeout_s = kMostSeconds;
    trial.memory_limit_gib = memory_limit_gib();
    return trial;
  }

  // The hash decides, wherever the image lies here.
  std::string image_of(const Row& row) const {
    if (is_plain_phantom(row.input.name)) return row.input.name;
    const auto found = settings_.images.find(row.input.sha256.value_or(""));
    return found == settings_.images.end() ? "" : found->second;
  }

  std::string absence_of(const Row& row, const Trial& trial) {
    if (num_ranks(trial) > 0) return "it ran on ranks";
    const int processors = usable_processors();
    if (const int threads = trial.options.value("threads", 1);
        threads > processors && !trial.options.contains("oversubscribe") && row.basis == Basis::kMeasured)
      return fmt::format("it needs {} processors; this machine has {}", threads, processors);
    try {
      return runner_.why_skipped(trial);
    } catch (const InputError& error) {  // an unknown peer
      return error.what();
    }
  }

  // Returns the first difference; empty: none.
  std::string difference(const Row& row, const TrialResult& result) const {
    if (!result.mesh) return fmt::format("no mesh here: {}: {}", result.reason, result.stderr_tail);
    const MeshRecord &theirs = *row.mesh, &ours = *result.mesh;
    if (is_repeatable(row)) {
      if (ours.cells != theirs.cells) return fmt::format("{} cells here, not {}", ours.cells, theirs.cells);
      if (ours.mesh_sha256 != theirs.mesh_sha256)
        return fmt::format("the mesh here has the hash {}, not {}", ours.mesh_sha256.value_or("none"),
                           theirs.mesh_sha256.value_or("none"));
    } else if (const double share = static_cast<double>(ours.cells) / static_cast<double>(theirs.cells);
               !(std::abs(share - 1) <= kShareOfCells)) {
      return fmt::format("{} cells here, not about {}", ours.cells, theirs.cells);
    }
    for (const auto& [claim, verdict] : theirs.verdicts.value_or(ByName<Proof>())) {
      const Proof* const here = ours.verdicts ? ours.verdicts->find(claim) : nullptr;
      if (verdict == Proof::kPass && (here == nullptr || *here != Proof::kPass))
        return fmt::format("{} is {} here", claim, here == nullptr ? "not judged" : to_string(*here));
    }
    if (row.status == Status::kOk && result.status != Status::kOk) return "not ok here: " + result.reason;
    return "";
  }

  std::string describe(const Row& row, const TrialResult& result) const {
    const auto verdicts = result.mesh->verdicts.value_or(ByName<Proof>());
    const auto passed =
        std::ranges::count_if(verdicts, [](const auto& each) { return each.second == Proof::kPass; });
    return fmt::format("{}: {}, {} of {} claims pass{}", name_of(row),
                       is_repeatable(row) && row.mesh->mesh_sha256
                           ? "the same mesh"
                           : fmt::format("{} cells", result.mesh->cells),
                       passed, verdicts.size(), result.replay ? ", equal to its replay" : "");
  }

  // A mesh may differ because another version of the mesher made it.
  std::string commits(const Row& row) const {
    if (row.programs.peer || row.programs.podm.sha256 == podm_sha256_) return "";
    return fmt::format("; its podm is {}..., the one here is {}...", row.programs.podm.sha256.substr(0, 12),
                       podm_sha256_.substr(0, 12));
  }

  const ExperimentsOn& experiments_;
  const RemeshSettings& settings_;
  const StopQuery& stop_requested_;
  TemporaryResults results_;
  std::string podm_sha256_;
  Preparer preparer_;
  TrialRunner runner_;
};

}  // namespace

Remeshing remesh_sample(const Submission& submission, const ExperimentsOn& experiments,
                        const RemeshSettings& settings, const StopQuery& stop_requested, Faults& faults) {
  Remeshing remeshing;
  if (settings.num_meshes == 0) return remeshing;
  Remesher remesher(experiments, settings, stop_requested);
  std::size_t num_tried = 0;
  for (const Row* row : drawn_rows(submission, settings.seed)) {
    if (num_tried == settings.num_meshes || stop_requested()) break;
    std::string absence;
    const std::string made = remesher.make(*row, submission.manifest.division, absence, faults);
    if (!made.empty()) remeshing.made.push_back(made);
    if (absence.empty())
      ++num_tried;
    else
      remeshing.not_made.push_back(fmt::format("{}: {}", name_of(*row), absence));
  }
  return remeshing;
}

}  // namespace podm::bench
