#include "experiments/experiment_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <span>
#include <utility>

#include "experiments/progress.h"
#include "experiments/verdicts.h"
#include "machine/environment.h"
#include "process/scratch_folder.h"
#include "process/sha256.h"
#include "process/stopwatch.h"
#include "rows/machine_state.h"
#include "rows/results_file.h"
#include "rows/table.h"
#include "trials/record.h"
#include "trials/trial_logs.h"

namespace podm::bench {
namespace {

// Stores the machine's topology in the folder of results once. Returns the value for the rows.
std::string store_topology(const Machine& machine, const std::string& results_folder) {
  if (machine.topology_xml.empty()) return Unavailable{"hwloc finds no topology"}.text();
  const std::string hash = sha256_of(machine.topology_xml);
  const std::string path = fmt::format("{}/topology-{}.xml", results_folder, hash);
  if (!std::filesystem::exists(path)) write_file(path, machine.topology_xml);
  return hash;
}

// Measures the seconds that this program itself spends between two rows.
class HarnessClock {
 public:
  double lap_without(double others_s) {
    const auto now = std::chrono::steady_clock::now();
    const double lap_s = std::chrono::duration<double>(now - std::exchange(last_, now)).count();
    return lap_s - others_s;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

std::string label_of(const Trial& trial, const Turn& turn) {
  if (turn.is_warmup) return fmt::format("{}, warm-up {} of {}", trial.name, turn.repeat, trial.warmups);
  return trial.repeats == 1 ? trial.name
                            : fmt::format("{}, repeat {} of {}", trial.name, turn.repeat, trial.repeats);
}

std::string one_line(const std::string& label, const TrialResult& result) {
  if (result.measured)
    return fmt::format("{}: {} in {:.2f} s", label, memory_levels({&*result.measured}),
                       result.process.wall_s);
  if (!result.mesh) return fmt::format("{}: {}: {}", label, to_string(result.status), result.reason);
  return fmt::format("{}: {}, {} cells in {:.2f} s, {:.2f} s in all", label, to_string(result.status),
                     result.mesh->cells, meshing_seconds(result.mesh->phases_s), result.process.wall_s);
}

// Runs the turns of one experiment, one after the other.
class ExperimentRun {
 public:
  ExperimentRun(Session& session, const Experiment& experiment, Plan plan)
      : session_(session),
        experiment_(experiment),
        plan_(std::move(plan)),
        path_(rows_path(session.command.results_folder, experiment)),
        file_(path_),
        rows_(plan_.trials.size()) {}

  // Returns true if every turn has a row of status ok or may be skipped. A promise that a peer does not keep
  // is a result, not a failure.
  bool run() {
    announce();
    Progress progress(expected_s());
    HarnessClock clock;
    for (const Round& round : rounds()) {
      if (session_.is_interrupted()) break;
      run_round(round, progress, clock);
    }
    for (const std::string& remark : machine_state(all_rows()).remarks()) fmt::print("{}\n", remark);
    fmt::print("{}Recorded in {}\n", format_table(rows_), path_);
    if (!session_.is_interrupted()) print_verdicts();
    return !session_.is_interrupted() && summarize();
  }

 private:
  using Round = std::span<const PlannedTurn>;

  std::vector<Round> rounds() const {
    std::vector<Round> rounds;
    const auto differ = [](const PlannedTurn& a, const PlannedTurn& b) {
      return a.turn.repeat != b.turn.repeat || a.turn.is_warmup != b.turn.is_warmup;
    };
    for (auto begin = plan_.turns.begin(); begin != plan_.turns.end();) {
      const auto end = std::find_if(begin, plan_.turns.end(),
                                    [&](const PlannedTurn& planned) { return differ(*begin, planned); });
      rounds.emplace_back(begin, end);
      begin = end;
    }
    return rounds;
  }

  bool is_measured(const PlannedTurn& planned) const {
    return basis_of(plan_.trials[planned.turn.trial].options, {}) == Basis::kMeasured;
  }

  // A round that an interrupt cuts short is not judged. The run that resumes it probes anew.
  void run_round(const Round& round, Progress& progress, HarnessClock& clock) {
    const bool is_probed = std::any_of(round.begin(), round.end(), [&](const PlannedTurn& planned) {
      return !planned.row && is_measured(planned);
    });
    if (is_probed)
      round_probe_ = session_.probes.begin();
    else
      session_.probes.pass();
    clock.lap_without(0);
    for (const PlannedTurn& planned : round) {
      if (session_.is_interrupted()) return;
      rows_[planned.turn.trial].push_back(planned.row ? *planned.row : run_turn(planned, progress, clock));
    }
    if (is_probed && !session_.is_interrupted()) end_round(round);
    clock.lap_without(0);
  }

  // Marks the round's measured rows, including rows of an earlier run, if the machine's speed moved.
  void end_round(const Round& round) {
    const Probe after = session_.probes.end();
    std::vector<Row*> rows;
    std::vector<Probe> probes{after};
    for (const PlannedTurn& planned : round) {
      Row& row = rows_[planned.turn.trial].back();
      if (row.basis != Basis::kMeasured || row.status == Status::kSkipped) continue;
      rows.push_back(&row);
      if (row.environment.probe) probes.push_back(*row.environment.probe);
    }
    if (!has_moved(probes)) return;
    std::vector<Row> marked;
    for (Row* row : rows) {
      row->probe_moved = true;
      row->environment.probe_after = after;
      marked.push_back(*row);
    }
    file_.replace_newest(marked);
  }

  std::vector<Row> all_rows() const {
    std::vector<Row> rows;
    for (const auto& of_trial : rows_) rows.insert(rows.end(), of_trial.begin(), of_trial.end());
    return rows;
  }

  std::vector<std::optional<double>> expected_s() const {
    std::vector<std::optional<double>> expected;
    for (const PlannedTurn& planned : plan_.turns)
      if (!planned.row) expected.push_back(plan_.expected[planned.turn.trial].seconds);
    return expected;
  }

  void announce() const {
    if (!seconds_matter())
      fmt::print(stderr, "PODM_BENCH_UNTIMED is set: the seconds of this run must not be compared\n");
    fmt::print(stderr, "{}: {} of {} trials, {} runs\n", experiment_.title, plan_.trials.size(),
               experiment_.trials.size(), plan_.turns.size());
    if (const std::size_t num_present = plan_.num_present(); num_present > 0)
      fmt::print(stderr, "{} of them skipped: already in {} (--again runs them anew)\n", num_present, path_);
  }

  Row run_turn(const PlannedTurn& planned, Progress& progress, HarnessClock& clock) {
    const Trial& trial = plan_.trials[planned.turn.trial];
    const std::string label = label_of(trial, planned.turn);
    progress.start_turn(label);
    TrialResult result = prepare(trial, progress);
    EnvironmentRecord environment = session_.environment;
    renew(environment);
    if (is_measured(planned)) environment.probe = round_probe_;
    const std::string key = session_.keys.of(trial, planned.turn, result.preparation);
    if (const auto known = plan_.finished.find(key); known != plan_.finished.end()) {
      progress.finish_turn(label + ": already measured");
      return known->second;
    }
    if (result.status == Status::kOk) result = run_in_scratch_folder(planned.turn, key, result, progress);
    RowContext context{experiment_.name, key, session_.command.order_seed, 0, session_.programs, environment};
    context.harness_s =
        clock.lap_without(result.preparation_s + result.process.wall_s + result.verification_s);
    const Row row = make_row(context, trial, planned.turn, result);
    if (result.status != Status::kSkipped) file_.append(row);
    progress.finish_turn(one_line(label, result));
    return row;
  }

  // The result has status kOk if the trial can start.
  TrialResult prepare(const Trial& trial, Progress& progress) {
    const Stopwatch watch;
    TrialResult result;
    result.preparation.image = trial.image;
    result.reason = session_.runner.why_skipped(trial);
    result.status = result.reason.empty() ? Status::kOk : Status::kSkipped;
    if (result.status == Status::kSkipped) return result;
    try {
      result.preparation = find_or_make(trial, progress);
    } catch (const PreparationError& error) {
      result.status = session_.is_interrupted() ? Status::kInterrupted : Status::kFailed;
      result.reason = error.what();
      result.command = error.command;
      result.process = error.process;
      result.stderr_tail = error.stderr_tail;
    }
    result.preparation_s = watch.seconds() - result.process.wall_s;
    return result;
  }

  Preparation find_or_make(const Trial& trial, Progress& progress) {
    if (const auto found = session_.preparer.find(trial)) return *found;
    const ScratchFolder scratch(session_.command.results_folder);
    return session_.preparer.make(
        trial, scratch.path(), [&](const std::string& step) { progress.show_step(step); },
        stop_query(progress));
  }

  StopQuery stop_query(Progress& progress) const {
    return [this, &progress] {
      progress.tick();
      return session_.is_interrupted();
    };
  }

  // Removes the mesh before the row is written. The mesh then takes no disk time, and the row finds space.
  TrialResult run_in_scratch_folder(const Turn& turn, const std::string& key, const TrialResult& prepared,
                                    Progress& progress) {
    const Trial& trial = plan_.trials[turn.trial];
    progress.show_step("");
    const ScratchFolder scratch(session_.command.results_folder);
    TrialResult result =
        session_.runner.run(trial, prepared.preparation, scratch.path(), stop_query(progress));
    result.preparation_s += prepared.preparation_s;
    if (result.status != Status::kSkipped) keep_logs(scratch.path(), session_.command.results_folder, key);
    if (session_.command.keep) keep(scratch, trial, turn);
    return result;
  }

  void keep(const ScratchFolder& scratch, const Trial& trial, const Turn& turn) const {
    const std::string path = fmt::format("{}/{}.{}.{}{}", session_.command.results_folder, experiment_.name,
                                         trial.name, turn.is_warmup ? "warmup" : "repeat", turn.repeat);
    scratch.keep(path);
    fmt::print(stderr, "kept: {}\n", path);
  }

  void print_verdicts() const { fmt::print("\n{}", format_verdicts({judge(experiment_, all_rows())})); }

  static bool is_good(const Row& row) {
    return row.status == Status::kOk || row.status == Status::kSkipped ||
           (row.programs.peer && row.status == Status::kUnmet);
  }

  bool summarize() const {
    std::map<std::string, int> num_by_status;
    bool are_all_good = true;
    for (const auto& rows : rows_)
      for (const Row& row : rows) {
        ++num_by_status[to_string(row.status)];
        are_all_good = are_all_good && is_good(row);
      }
    std::vector<std::string> counts;
    for (const auto& [status, number] : num_by_status) counts.push_back(fmt::format("{} {}", number, status));
    fmt::print(stderr, "{}: {}\n", experiment_.name, fmt::join(counts, ", "));
    return are_all_good;
  }

  Session& session_;
  const Experiment& experiment_;
  Plan plan_;
  std::string path_;
  RecordFile file_;
  std::vector<std::vector<Row>> rows_;  // one list per trial, including rows of earlier runs
  std::optional<Probe> round_probe_;    // at the start of the current round
};

}  // namespace

Session::Session(const RunCommand& given, const std::string& mesher_sha256, const Machine& machine,
                 StopQuery query)
    : command(given),
      is_interrupted(std::move(query)),
      preparer(given.programs.podm, mesher_sha256, given.results_folder),
      keys(mesher_sha256, machine.summary, Peers(given.programs.peers, given.programs.podm),
           given.programs.podm),
      runner(given.programs) {
  programs = describe_programs(command.programs);
  environment = environment_of_run(machine.summary);
  environment.topology_sha256 = store_topology(machine, command.results_folder);
}

bool run_experiment(Session& session, const Experiment& experiment, Plan plan) {
  return ExperimentRun(session, experiment, std::move(plan)).run();
}

}  // namespace podm::bench
