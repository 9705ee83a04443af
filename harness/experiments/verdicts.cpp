#include "experiments/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "rows/row_filter.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

constexpr const char* kSchema = "podm-bench-verdicts/1";

const char* in_words(Verdict verdict) {
  return verdict == Verdict::kHolds         ? "holds"
         : verdict == Verdict::kDoesNotHold ? "DOES NOT HOLD"
                                            : "cannot be decided";
}

std::string reason_with_note(const Claim& claim, const Judgement& judgement) {
  return judgement.verdict != Verdict::kDoesNotHold || claim.note.empty()
             ? judgement.reason
             : judgement.reason + ". " + claim.note;
}

// Calls `visit` with each experiment, claim and judgement.
template <class Visit>
void for_each_claim(const std::vector<ExperimentVerdicts>& all, Visit&& visit) {
  for (const ExperimentVerdicts& verdicts : all)
    for (std::size_t i = 0; i < verdicts.judgements.size(); ++i)
      visit(*verdicts.experiment, verdicts.experiment->claims[i], verdicts.judgements[i]);
}

}  // namespace

ExperimentVerdicts judge(const Experiment& experiment, const std::vector<Row>& rows) {
  std::set<std::string> stems;
  for (const Trial& trial : experiment.trials) stems.insert(stem_of(trial.name));
  const auto is_foreign = [&](const Row& row) { return !stems.contains(stem_of(row.trial)); };
  std::vector<Row> judged = rows_to_judge(rows), others = rows_of_other_machines(rows);
  std::erase_if(judged, is_foreign);
  std::erase_if(others, is_foreign);
  ExperimentVerdicts verdicts{&experiment, {}, machine_state(judged), describe_left_out(others)};
  for (const Claim& claim : experiment.claims) verdicts.judgements.push_back(judge(claim, judged));
  return verdicts;
}

namespace {

// Sentences on the machine that an experiment's rows were measured on.
std::vector<std::string> remarks_of(const ExperimentVerdicts& verdicts) {
  std::vector<std::string> remarks = verdicts.machine.remarks();
  if (!verdicts.left_out.empty()) remarks.push_back(verdicts.left_out);
  return remarks;
}

std::string remarks_in_lines(const std::vector<ExperimentVerdicts>& all) {
  std::string lines;
  for (const ExperimentVerdicts& verdicts : all)
    for (const std::string& remark : remarks_of(verdicts))
      lines += fmt::format("{}: {}\n", verdicts.experiment->name, remark);
  return lines;
}

}  // namespace

std::string format_verdicts(const std::vector<ExperimentVerdicts>& all) {
  std::vector<std::vector<std::string>> lines{
      {"verdict", "experiment", "claim", "basis", "value", "bound", "rows", "why"}};
  std::string failed;
  int numbers[] = {0, 0, 0};
  for_each_claim(all, [&](const Experiment& experiment, const Claim& claim, const Judgement& judgement) {
    ++numbers[static_cast<int>(judgement.verdict)];
    lines.push_back({in_words(judgement.verdict), experiment.name, claim.name, to_string(claim.basis),
                     judgement.value ? fmt::format("{:.3g}", *judgement.value) : "-", describe_bound(claim),
                     std::to_string(judgement.num_rows), judgement.reason});
    if (judgement.verdict == Verdict::kDoesNotHold)
      failed += fmt::format("{}: {} DOES NOT HOLD: {}{}{}\n", experiment.name, claim.name, claim.statement,
                            claim.note.empty() ? "" : " ", claim.note);
  });
  return fmt::format("{}{}{}Claims: {} hold, {} do not hold, {} cannot be decided here\n",
                     remarks_in_lines(all), align(lines, 4), failed, numbers[0], numbers[1], numbers[2]);
}

Json verdicts_as_json(const std::vector<ExperimentVerdicts>& all) {
  Json experiments = Json::array();
  for (const ExperimentVerdicts& verdicts : all) {
    const Experiment& experiment = *verdicts.experiment;
    experiments.push_back({{"experiment", experiment.name},
                           {"title", experiment.title},
                           {"claim", experiment.claim},
                           {"paper", experiment.paper.empty() ? Json() : Json(experiment.paper)},
                           {"measured", verdicts.machine.measured},
                           {"disturbed", verdicts.machine.disturbed},
                           {"probe_moved", verdicts.machine.moved},
                           {"remarks", remarks_of(verdicts)},
                           {"claims", Json::array()}});
    for_each_claim({verdicts}, [&](const Experiment&, const Claim& claim, const Judgement& judgement) {
      experiments.back()["claims"].push_back({{"name", claim.name},
                                              {"statement", claim.statement},
                                              {"basis", to_string(claim.basis)},
                                              {"verdict", to_string(judgement.verdict)},
                                              {"reason", reason_with_note(claim, judgement)},
                                              {"value", judgement.value ? Json(*judgement.value) : Json()},
                                              {"bound", describe_bound(claim)},
                                              {"n", judgement.num_rows}});
    });
  }
  return {{"schema", kSchema}, {"experiments", experiments}};
}

}  // namespace podm::bench
