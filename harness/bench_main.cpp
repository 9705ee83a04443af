// The main program of podm-bench: reads the command line and runs a command.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "experiments/commands.h"
#include "gate/gate_command.h"
#include "machine/commands.h"
#include "process/share.h"
#include "submissions/commands.h"

namespace podm::bench {
namespace {

Programs default_programs() {
  return {beside_this_program("podm"),     beside_this_program("podm-verify"),
          share_of_this_program("peers"),  beside_this_program("podm-bench"),
          share_of_this_program("likwid"), share_of_this_program("solvers/dolfinx/run")};
}

// Adds an option whose value help shows as `type`.
template <class Value>
CLI::Option* add_option(CLI::App& app, const char* name, const char* type, Value& value,
                        const std::string& description) {
  return app.add_option(name, value, description)->option_text(type);
}

void add_programs(CLI::App& app, Programs& programs) {
  add_option(app, "--podm", "FILE", programs.podm, "file of the mesher [default: podm beside this program]");
  add_option(app, "--verifier", "FILE", programs.verifier,
             "file of the verifier, or none [default: podm-verify beside this program]");
  add_option(app, "--peers", "FOLDER", programs.peers,
             "folder of other meshers [default: those that come with this program]");
}

// Adds the command. Sets `exit_code` when the command was chosen and has ended.
void add_run(CLI::App& program, int& exit_code) {
  struct State {
    RunCommand command;
    std::string tier;
    bool is_dry = false;
  };
  const auto state = std::make_shared<State>();
  RunCommand& command = state->command;
  command.programs = default_programs();
  CLI::App& app = *program.add_subcommand("run", "run the trials of experiments that are not measured yet");
  add_option(app, "EXPERIMENT", " ", command.experiment_paths, "files of experiments/")->required();
  add_option(app, "--only", "PATTERN", command.only,
             "run only trials of this name; * and ? match any [default: all]");
  add_option(app, "--tier", "kick-tires|default|full", state->tier,
             "run this tier: kick-tires, default or full [default: all]");
  add_option(app, "--image", "FILE|FOLDER", command.images,
             "a label image, or a folder of them, in place of all inputs; repeatable [default: the inputs]")
      ->allow_extra_args(false);
  app.add_flag("--dry-run", state->is_dry, "print trials, time, memory and disk; run nothing [default: no]");
  app.add_flag("--again", command.again, "also run what is measured already [default: skip it]");
  app.add_flag("--keep", command.keep,
               "keep the files of each trial, meshes included [default: its messages alone]");
  add_option(app, "--order-seed", "N", command.order_seed,
             fmt::format("draws the order within each round [default: {}]", command.order_seed));
  add_option(app, "--results", "FOLDER", command.results_folder,
             fmt::format("folder of the JSON lines [default: {}]", kResultsFolder));
  add_programs(app, command.programs);
  app.callback([state, &exit_code] {
    if (state->command.programs.verifier == "none") state->command.programs.verifier.clear();
    if (!state->tier.empty()) state->command.tier = parse_tier(state->tier);
    exit_code = state->is_dry ? dry_run(state->command) : run(state->command);
  });
}

void add_list(CLI::App& program, int& exit_code) {
  const auto folder = std::make_shared<std::string>(kExperimentsFolder);
  CLI::App& app = *program.add_subcommand("list", "list experiments: title, trials, expected time");
  add_option(app, "FOLDER", " ", *folder, fmt::format("where they are [default: {}]", *folder));
  app.callback([folder, &exit_code] { exit_code = list(*folder); });
}

void add_verdicts(CLI::App& program, int& exit_code) {
  struct State {
    std::vector<std::string> experiment_paths;
    std::string results_folder = kResultsFolder, json_path;
  };
  const auto state = std::make_shared<State>();
  CLI::App& app = *program.add_subcommand("verdicts", "judge the claims of experiments by their rows");
  add_option(app, "EXPERIMENT", " ", state->experiment_paths, "files of experiments/")->required();
  add_option(app, "--results", "FOLDER", state->results_folder,
             fmt::format("folder of the JSON lines [default: {}]", kResultsFolder));
  add_option(app, "--json", "FILE", state->json_path, "also write them as JSON to this file [default: none]");
  app.callback([state, &exit_code] {
    exit_code = verdicts(state->experiment_paths, state->results_folder, state->json_path);
  });
}

void add_latency(CLI::App& program, int& exit_code) {
  const auto path = std::make_shared<std::string>();
  CLI::App& app = *program.add_subcommand("latency", "measure the latency of each memory level, Table 3");
  add_option(app, "--record", "FILE", *path, "write it as JSON to this file [default: standard output]");
  app.callback([path, &exit_code] { exit_code = latency(*path); });
}

void add_sharing(CLI::App& program, int& exit_code) {
  CLI::App& app =
      *program.add_subcommand("sharing", "measure what cache lines and new pages cost that threads share");
  app.callback([&exit_code] { exit_code = sharing(); });
}

void add_machine(CLI::App& program, int& exit_code) {
  const auto as_json = std::make_shared<bool>(false);
  CLI::App& app =
      *program.add_subcommand("machine", "print the identity and the present speed of this machine");
  app.add_flag("--json", *as_json, "print one line of JSON, as rows hold it [default: words]");
  app.callback([as_json, &exit_code] { exit_code = show_machine(*as_json); });
}

void add_compare(CLI::App& program, int& exit_code) {
  const auto paths = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App& app =
      *program.add_subcommand("compare", "compare two files of records; exits with 1 when B is worse");
  add_option(app, "A", " ", paths->first, "JSON lines of the program before")->required();
  add_option(app, "B", " ", paths->second, "JSON lines of the program after")->required();
  app.callback([paths, &exit_code] { exit_code = compare_files(paths->first, paths->second); });
}

void add_gate(CLI::App& program, int& exit_code) {
  struct State {
    GateOptions options;
    bool renews = false;
  };
  const auto state = std::make_shared<State>();
  GateOptions& options = state->options;
  options.head = beside_this_program("podm");
  CLI::App& app = *program.add_subcommand(
      "gate", "judge a change of the mesher; exits with 1 when it must not be merged");
  add_option(app, "--head", "FILE", options.head,
             "file of the mesher to judge [default: podm beside this program]");
  add_option(app, "--base", "FILE", options.base,
             "file of the mesher before the change [default: compare no seconds]");
  add_option(app, "--tier", "1|2|3", options.tiers, "1 work, 2 seconds, 3 scaling; repeatable [default: all]")
      ->check(CLI::Range(1, 3));
  add_option(app, "--budgets", "FILE", options.budgets_path,
             fmt::format("committed work [default: {}]", options.budgets_path));
  add_option(app, "--order-seed", "N", options.order_seed,
             fmt::format("draws the order within each round [default: {}]", options.order_seed));
  app.add_flag("--renew", state->renews,
               "write the work of the head into the file of budgets [default: judge]");
  app.callback([state, &exit_code] { exit_code = run_gate(state->options, state->renews); });
}

void add_gate_evidence(CLI::App& program, int& exit_code) {
  const auto command = std::make_shared<EvidenceCommand>();
  command->podm = beside_this_program("podm");
  CLI::App& app = *program.add_subcommand(
      "gate-evidence", "count how often the gate's answer about seconds errs on recorded rounds");
  add_option(app, "FILE", " ", command->rounds_path, "JSON lines of the rounds")->required();
  add_option(app, "--rounds", "N", command->num_rounds,
             "first record this number of further rounds, with planted slowdowns [default: 0]")
      ->check(CLI::NonNegativeNumber);
  add_option(app, "--podm", "FILE", command->podm,
             "file of the mesher to record [default: podm beside this program]");
  add_option(app, "--budgets", "FILE", command->budgets_path,
             fmt::format("names the trial to record [default: {}]", command->budgets_path));
  add_option(app, "--order-seed", "N", command->order_seed,
             fmt::format("draws the order within rounds [default: {}]", command->order_seed));
  add_option(app, "--json", "FILE", command->json_path,
             "also write the counts as JSON lines to this file [default: none]");
  app.callback([command, &exit_code] { exit_code = gate_evidence(*command); });
}

void add_gate_simulation(CLI::App& program, int& exit_code) {
  struct State {
    int num_tries = 3000;
    std::string json_path;
  };
  const auto state = std::make_shared<State>();
  CLI::App& app = *program.add_subcommand(
      "gate-simulation", "count how often the gate's answer about seconds errs on a simulated machine");
  add_option(app, "--tries", "N", state->num_tries,
             fmt::format("tries per noise and planted slowdown [default: {}]", state->num_tries))
      ->check(CLI::PositiveNumber);
  add_option(app, "--json", "FILE", state->json_path,
             "also write the counts as JSON lines to this file [default: none]");
  app.callback([state, &exit_code] { exit_code = gate_simulation(state->num_tries, state->json_path); });
}

void add_pack(CLI::App& program, int& exit_code) {
  const auto command = std::make_shared<PackCommand>();
  command->results_folder = kResultsFolder;
  command->experiments_folder = kExperimentsFolder;
  CLI::App& app = *program.add_subcommand("pack", "pack rows, logs and hashes into an archive for others");
  add_option(app, "EXPERIMENT", " ", command->experiments,
             "pack only the rows of these experiments [default: all]");
  add_option(app, "-o,--output", "FILE", command->output, "the archive, .tar.gz [required]")->required();
  add_option(app, "--submitter", "TEXT", command->submitter, "your name, and your institution [required]")
      ->required();
  add_option(
      app, "--division", "closed|open", command->division,
      "closed: inputs and bounds of the experiments; open: anything that you declare [default: closed]");
  add_option(app, "--declaration", "FILE", command->declaration_path,
             "a text about how the rows were made; required for open [default: none]");
  add_option(app, "--results", "FOLDER", command->results_folder,
             fmt::format("folder of the JSON lines [default: {}]", kResultsFolder));
  add_option(app, "--experiments", "FOLDER", command->experiments_folder,
             fmt::format("folder of the suite's experiments [default: {}]", kExperimentsFolder));
  app.callback([command, &exit_code] { exit_code = pack_submission(*command); });
}

void add_check(CLI::App& program, int& exit_code) {
  const auto command = std::make_shared<CheckCommand>();
  command->programs = default_programs();
  command->experiments_folder = kExperimentsFolder;
  CLI::App& app =
      *program.add_subcommand("check", "judge a packed archive; exits with 1 when it is not valid");
  add_option(app, "ARCHIVE", " ", command->archive, "an archive of podm-bench pack")->required();
  add_option(app, "--sample", "N", command->num_meshes,
             fmt::format("meshes to make again on this machine [default: {}]", command->num_meshes));
  add_option(app, "--sample-seed", "N", command->seed,
             "seed of the choice of these meshes [default: at random]");
  add_option(app, "--image", "FILE|FOLDER", command->images,
             "a label image, or a folder of them, that rows may have read; repeatable [default: none]")
      ->allow_extra_args(false);
  add_option(app, "--experiments", "FOLDER", command->experiments_folder,
             fmt::format("folder of the suite's experiments [default: {}]", kExperimentsFolder));
  add_programs(app, command->programs);
  app.callback([command, &exit_code] { exit_code = check_submission(*command); });
}

int main_or_throw(int argc, char** argv) {
  CLI::App program("Runs mesher experiments, one process per trial, and records each as a JSON line.",
                   "podm-bench");
  program.set_version_flag("--version", "podm-bench " PODM_VERSION);
  program.require_subcommand(1);
  program.footer(
      "Exit codes: 0 success, 1 a trial failed or missed a guarantee, 2 bad usage or input, "
      "3 internal error.");
  int exit_code = 0;
  add_run(program, exit_code);
  add_list(program, exit_code);
  add_verdicts(program, exit_code);
  add_latency(program, exit_code);
  add_sharing(program, exit_code);
  add_machine(program, exit_code);
  add_compare(program, exit_code);
  add_pack(program, exit_code);
  add_check(program, exit_code);
  add_gate(program, exit_code);
  add_gate_evidence(program, exit_code);
  add_gate_simulation(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kExitInput;
  }
  return exit_code;
}

}  // namespace
}  // namespace podm::bench

int main(int argc, char** argv) {
  try {
    return podm::bench::main_or_throw(argc, argv);
  } catch (const podm::bench::InputError& error) {
    fmt::print(stderr, "podm-bench: {}\n", error.what());
    return podm::bench::kExitInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "podm-bench: internal error: {}\n", error.what());
    return podm::bench::kExitInternal;
  }
}
