// podm-bench: runs the experiments of experiments/*.toml and records each trial as a JSON line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "environment.h"
#include "gate_command.h"
#include "record.h"
#include "table.h"
#include "trial.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kExitMissed = 1;
constexpr int kExitInput = 2;

struct RunCommand {
  std::string experiment_path;
  std::string only;  ///< the one trial to run; empty: all
  std::string results_folder = "results/runs";
  Programs programs;
  bool keep = false;
};

std::atomic<bool> interrupted = false;

void on_signal(int) { interrupted = true; }

// A new folder for the files of one trial, removed with all it holds unless kept.
class ScratchFolder {
 public:
  ScratchFolder(const std::string& stem, bool keep) : path_(stem + ".XXXXXX"), keep_(keep) {
    if (mkdtemp(path_.data()) == nullptr)
      throw InputError(fmt::format("cannot make a folder {}: {}", path_, std::strerror(errno)));
  }
  ~ScratchFolder() {
    std::error_code error;
    if (!keep_) fs::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool keep_;
};

std::string one_line(const Trial& trial, const TrialResult& result) {
  if (!result.record.is_object())
    return fmt::format("{}: {}: {}", trial.name, to_string(result.status), result.reason);
  return fmt::format("{}: {}, {} cells in {:.2f} s, {:.2f} s in all", trial.name, to_string(result.status),
                     result.record["cells"].get<std::uint64_t>(), meshing_seconds(result.record),
                     result.process.wall_s);
}

TrialResult run_and_record(const Experiment& experiment, const Trial& trial, const RunCommand& command,
                           RecordFile& rows) {
  const std::string stem = fmt::format("{}/{}.{}", command.results_folder, experiment.name, trial.name);
  const ScratchFolder scratch(stem, command.keep);
  const auto before = environment(scratch.path());  // the load that the trial meets
  TrialResult result = run_trial(trial, command.programs, scratch.path(), [] { return interrupted.load(); });
  if (result.status != Status::kSkipped) rows.append(make_row(experiment, trial, result, before));
  if (command.keep) fmt::print(stderr, "kept: {}\n", scratch.path());
  return result;
}

std::vector<Trial> chosen_trials(const Experiment& experiment, const RunCommand& command) {
  if (command.only.empty()) return experiment.trials;
  for (const Trial& trial : experiment.trials)
    if (trial.name == command.only) return {trial};
  throw InputError(fmt::format("{}: no trial '{}'", command.experiment_path, command.only));
}

int run(const RunCommand& command) {
  const Experiment experiment = read_experiment(command.experiment_path);
  const auto trials = chosen_trials(experiment, command);
  std::error_code error;  // RecordFile tells when there is no folder
  fs::create_directories(command.results_folder, error);
  const std::string rows_path = fmt::format("{}/{}.jsonl", command.results_folder, experiment.name);
  RecordFile rows(rows_path);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);

  fmt::print(stderr, "{}: {} of {} trials; all take about {:g} minutes\n", experiment.title, trials.size(),
             experiment.trials.size(), experiment.expected_minutes);
  bool all_well = true;
  std::vector<std::pair<Trial, TrialResult>> results;
  for (const Trial& trial : trials) {
    if (interrupted) break;
    const TrialResult result = run_and_record(experiment, trial, command, rows);
    fmt::print(stderr, "[{}/{}] {}\n", results.size() + 1, trials.size(), one_line(trial, result));
    all_well = all_well && (result.status == Status::kOk || result.status == Status::kSkipped);
    results.emplace_back(trial, result);
  }
  fmt::print("{}Recorded in {}\n", format_table(results), rows_path);
  return all_well && !interrupted ? 0 : kExitMissed;
}

int list(const std::string& folder) {
  for (const std::string& path : experiment_files(folder)) {
    const Experiment experiment = read_experiment(path);
    fmt::print("{}  {}  ({} trials, about {:g} minutes)\n", path, experiment.title, experiment.trials.size(),
               experiment.expected_minutes);
  }
  return 0;
}

std::string beside_this_program(const char* name) {
  return (fs::read_symlink("/proc/self/exe").parent_path() / name).string();
}

int main_or_throw(int argc, char** argv) {
  CLI::App program("Runs mesher experiments, one process a trial, and records each as a JSON line.",
                   "podm-bench");
  program.require_subcommand(1);
  program.footer("Exit codes: 0 success, 1 a trial failed or missed a guarantee, 2 bad usage or input.");
  RunCommand command;
  command.programs = {beside_this_program("podm"), beside_this_program("podm-verify")};
  CLI::App& run_app = *program.add_subcommand("run", "run the trials of an experiment");
  run_app.add_option("EXPERIMENT", command.experiment_path, "a file of experiments/")->required();
  run_app.add_option("--only", command.only, "run this trial alone [default: all]");
  run_app.add_option("--results", command.results_folder, "folder of the JSON lines [default: results/runs]");
  run_app.add_option("--podm", command.programs.podm, "the mesher [default: the podm beside this program]");
  run_app.add_option("--verifier", command.programs.verifier,
                     "the verifier, or none [default: the podm-verify beside this program]");
  run_app.add_flag("--keep", command.keep, "keep each trial's mesh and messages [default: delete them]");
  std::string folder = "experiments";
  CLI::App& list_app = *program.add_subcommand("list", "list experiments: title, trials, expected time");
  list_app.add_option("FOLDER", folder, "where they are [default: experiments]");
  int exit_code = 0;
  add_compare(program, exit_code);
  add_gate(program, beside_this_program("podm"), exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kExitInput;
  }
  if (!run_app.parsed() && !list_app.parsed()) return exit_code;
  if (command.programs.verifier == "none") command.programs.verifier.clear();
  return run_app.parsed() ? run(command) : list(folder);
}

}  // namespace
}  // namespace podm::bench

int main(int argc, char** argv) {
  try {
    return podm::bench::main_or_throw(argc, argv);
  } catch (const podm::bench::InputError& error) {
    fmt::print(stderr, "podm-bench: {}\n", error.what());
    return podm::bench::kExitInput;
  }
}
