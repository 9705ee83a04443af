#include "experiments/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "rows/row_filter.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

constexpr const char* kSchema = "podm-bench-verdicts/2";
constexpr const char* kWithdrawn = "withdrawn";

const char* in_words(Verdict verdict) {
  constexpr std::array kWords{"holds", "DOES NOT HOLD", "not resolved", "cannot be decided"};
  return kWords[static_cast<std::size_t>(verdict)];
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

// Returns the claims that an experiment no longer makes, including superseded ones.
std::vector<WithdrawnClaim> former_claims(const Experiment& experiment) {
  std::vector<WithdrawnClaim> former = experiment.withdrawn;
  for (const Claim& claim : experiment.claims)
    for (const std::string& name : claim.supersedes)
      former.push_back({name, claim.place, "", claim.reason, claim.name});
  return former;
}

std::string why_withdrawn(const WithdrawnClaim& claim) {
  return claim.superseded_by.empty() ? claim.reason
                                     : fmt::format("superseded by {}: {}", claim.superseded_by, claim.reason);
}

Json interval_as_json(const Judgement& judgement) {
  if (!judgement.interval) return {};
  const auto bounded = [](double bound) { return std::isfinite(bound) ? Json(bound) : Json(); };
  return {{"low", bounded(judgement.interval->low)},
          {"high", bounded(judgement.interval->high)},
          {"coverage", judgement.interval->coverage},
          {"rounds", judgement.num_rounds}};
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json claim_as_json(const Claim& claim, const Judgement& judgement) {
  return {{"name", claim.name},
          {"statement", claim.statement},
          {"basis", to_string(claim.basis)},
          {"verdict", to_string(judgement.verdict)},
          {"reason", reason_with_note(claim, judgement)},
          {"value", or_null(judgement.value)},
          {"interval", interval_as_json(judgement)},
          {"rounds_needed", or_null(judgement.rounds_needed)},
          {"bound", describe_bound(claim)},
          {"sizes", judgement.sizes},
          {"n", judgement.num_rows}};
}

Json withdrawn_as_json(const WithdrawnClaim& claim) {
  return {{"name", claim.name},
          {"statement", claim.statement},
          {"verdict", kWithdrawn},
          {"reason", claim.reason},
          {"superseded_by", claim.superseded_by.empty() ? Json() : Json(claim.superseded_by)}};
}

std::string interval_in_words(const Judgement& judgement) {
  if (!judgement.interval || judgement.num_rounds < 2) return "-";
  return fmt::format("{:.3g} to {:.3g}, {:.1f} %", judgement.interval->low, judgement.interval->high,
                     100 * judgement.interval->coverage);
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

// Returns sentences about the machine of an experiment's rows.
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
      {"verdict", "experiment", "claim", "basis", "value", "interval", "bound", "rows", "why"}};
  std::string failed;
  int numbers[] = {0, 0, 0, 0};
  for_each_claim(all, [&](const Experiment& experiment, const Claim& claim, const Judgement& judgement) {
    ++numbers[static_cast<int>(judgement.verdict)];
    lines.push_back({in_words(judgement.verdict), experiment.name, claim.name, to_string(claim.basis),
                     judgement.value ? fmt::format("{:.3g}", *judgement.value) : "-",
                     interval_in_words(judgement), describe_bound(claim), std::to_string(judgement.num_rows),
                     judgement.reason});
    if (judgement.verdict == Verdict::kDoesNotHold)
      failed += fmt::format("{}: {} DOES NOT HOLD: {}{}{}\n", experiment.name, claim.name, claim.statement,
                            claim.note.empty() ? "" : " ", claim.note);
  });
  std::size_t num_withdrawn = 0;
  for (const ExperimentVerdicts& verdicts : all)
    for (const WithdrawnClaim& claim : former_claims(*verdicts.experiment)) {
      ++num_withdrawn;
      lines.push_back(
          {kWithdrawn, verdicts.experiment->name, claim.name, "-", "-", "-", "-", "-", why_withdrawn(claim)});
    }
  return fmt::format(
      "{}{}{}Claims: {} hold, {} do not hold, {} not resolved, {} cannot be decided here; {} withdrawn or "
      "superseded\n",
      remarks_in_lines(all), align(lines, 4), failed, numbers[0], numbers[1], numbers[2], numbers[3],
      num_withdrawn);
}

Json verdicts_as_json(const std::vector<ExperimentVerdicts>& all) {
  Json experiments = Json::array();
  for (const ExperimentVerdicts& verdicts : all) {
    const Experiment& experiment = *verdicts.experiment;
    Json claims = Json::array(), withdrawn = Json::array();
    for_each_claim({verdicts}, [&](const Experiment&, const Claim& claim, const Judgement& judgement) {
      claims.push_back(claim_as_json(claim, judgement));
    });
    for (const WithdrawnClaim& claim : former_claims(experiment))
      withdrawn.push_back(withdrawn_as_json(claim));
    experiments.push_back({{"experiment", experiment.name},
                           {"title", experiment.title},
                           {"claim", experiment.claim},
                           {"paper", experiment.paper.empty() ? Json() : Json(experiment.paper)},
                           {"measured", verdicts.machine.measured},
                           {"disturbed", verdicts.machine.disturbed},
                           {"probe_moved", verdicts.machine.moved},
                           {"remarks", remarks_of(verdicts)},
                           {"claims", claims},
                           {"withdrawn", withdrawn}});
  }
  return {{"schema", kSchema}, {"experiments", experiments}};
}

}  // namespace podm::bench
