#include "experiments/judge.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

#include "experiments/findings.h"

namespace podm::bench {
namespace {

bool does_hold(const Finding& finding) { return finding.decision.outcome == Outcome::kHolds; }

// A group that breaks the claim outweighs a group that does not resolve it.
int weight_of(const Finding& finding) {
  switch (finding.decision.outcome) {
    case Outcome::kFails:
      return 3;
    case Outcome::kNotResolved:
      return finding.decision.agrees_on_few_rounds ? 1 : 2;
    case Outcome::kHolds:
      break;
  }
  return 0;
}

// "3 of 4 hold; threads=256: 1.2 over 2.4 s".
std::string describe(const Findings& findings, const Finding& worst) {
  const auto& found = findings.found;
  const auto is_same = [&](const Finding& other) { return other.text == worst.text; };
  if (does_hold(worst) && found.size() > 1 && std::all_of(found.begin(), found.end(), is_same))
    return fmt::format("{} in each of {}", worst.text, found.size());
  std::string text = worst.label.empty() ? worst.text : worst.label + ": " + worst.text;
  if (!worst.decision.doubt.empty()) text += ": " + worst.decision.doubt;
  if (found.size() == 1) return text;
  if (does_hold(worst)) return fmt::format("nearest of {}: {}", found.size(), text);
  const bool is_open = worst.decision.outcome == Outcome::kNotResolved;
  const auto is_better = [&](const Finding& finding) {
    return is_open ? finding.decision.outcome != Outcome::kNotResolved : does_hold(finding);
  };
  return fmt::format("{} of {} {}; {}", std::count_if(found.begin(), found.end(), is_better), found.size(),
                     is_open ? "resolved" : "hold", text);
}

Verdict verdict_of(Outcome outcome) {
  return outcome == Outcome::kHolds   ? Verdict::kHolds
         : outcome == Outcome::kFails ? Verdict::kDoesNotHold
                                      : Verdict::kNotResolved;
}

// The judgement of a claim at one size of an experiment.
struct Attempt {
  Judgement judgement;
  std::string size;
  bool has_rows = false, has_failed_rows = false;
  bool agrees_on_few_rounds = false;
  double excess = 0;  // of the group that decides
};

Attempt conclude(const Findings& findings) {
  const auto& found = findings.found;
  const auto worst = std::max_element(found.begin(), found.end(), [](const Finding& a, const Finding& b) {
    return std::pair(weight_of(a), a.excess) < std::pair(weight_of(b), b.excess);
  });
  Attempt attempt;
  attempt.has_rows = true;
  attempt.has_failed_rows = findings.has_failed_rows;
  Judgement& judgement = attempt.judgement;
  for (const Finding& finding : found) judgement.num_rows += finding.num_rows;
  if (worst == found.end() || (worst->decision.outcome != Outcome::kFails && !findings.missing.empty())) {
    judgement.reason = findings.missing;
    return attempt;
  }
  judgement.verdict = verdict_of(worst->decision.outcome);
  attempt.agrees_on_few_rounds = worst->decision.agrees_on_few_rounds;
  attempt.excess = worst->excess;
  if (std::isfinite(worst->estimate.value)) judgement.value = worst->estimate.value;
  judgement.interval = worst->estimate.interval;
  judgement.num_rounds = worst->estimate.num_rounds;
  judgement.rounds_needed = worst->decision.rounds_needed;
  judgement.reason = describe(findings, *worst);
  return attempt;
}

std::optional<double> cores_of(const Row& row) {
  const auto* const cores = std::get_if<std::uint64_t>(&row.environment.cores);
  if (cores == nullptr) return {};
  return std::min(static_cast<double>(*cores), static_cast<double>(row.environment.usable_processors));
}

double packages_of(const Row& row) {
  const auto* const packages = std::get_if<std::uint64_t>(&row.environment.packages);
  return packages == nullptr ? 1 : std::max(1.0, static_cast<double>(*packages));
}

// Returns the reason why the rows' machine cannot decide the claim; empty: it can.
std::string missing_cores(const Claim& claim, const RowPointers& rows) {
  if (claim.needs_cores == 0) return "";
  const auto cores = cores_of(*rows.front());
  if (!cores) return "the rows do not record how many cores their machine has";
  return *cores >= claim.needs_cores ? "" : fmt::format("needs {} cores, has {}", claim.needs_cores, *cores);
}

double threads_of(const Row& row) { return asked_of(row).value("threads", 1.0); }

RowPointers within_extent(const Claim& claim, RowPointers rows) {
  if (rows.empty() || claim.extent == Extent::kAll) return rows;
  double most = 0;
  if (claim.extent == Extent::kMostThreads)
    for (const Row* row : rows) most = std::max(most, threads_of(*row));
  const bool is_least = claim.extent == Extent::kMostThreads;
  std::erase_if(rows, [&](const Row* row) {
    return is_least ? threads_of(*row) < most
                    : threads_of(*row) > cores_of(*row).value_or(0) / packages_of(*row);
  });
  return rows;
}

// Returns the reason why planned rows did not run.
std::string why_skipped(const RowPointers& skipped) {
  if (skipped.empty()) return "";
  return fmt::format(" ({} skipped: {})", skipped.front()->trial, skipped.front()->reason);
}

struct Chosen {
  RowPointers rows, skipped;
};

Chosen choose(const Claim& claim, const std::vector<Row>& rows, const std::string& pattern) {
  Chosen chosen;
  for (const Row& row : rows) {
    if (!pattern.empty() && fnmatch(pattern.c_str(), stem_of(row.trial).c_str(), 0) != 0) continue;
    if (!is_of(row, claim.basis) || !matches(options_of(row), claim.where)) continue;
    (row.status == Status::kSkipped ? chosen.skipped : chosen.rows).push_back(&row);
  }
  return chosen;
}

Attempt judge_size(const Claim& claim, const std::vector<Row>& all_rows, const std::string& pattern) {
  const Chosen chosen = choose(claim, all_rows, pattern);
  const RowPointers rows = within_extent(claim, chosen.rows);
  Attempt attempt;
  const std::string missing = missing_value(claim.where, rows);
  if (rows.empty()) {
    attempt.judgement.reason =
        pattern.empty() ? "no rows" : fmt::format("no rows: trial {}", fmt::join(claim.trials, " or "));
  } else if (const std::string reason = missing_cores(claim, rows); !reason.empty()) {
    attempt.judgement.reason = reason;
  } else {
    attempt = conclude(find(claim, rows));
    // An incomplete set of rows can only refute the claim.
    if (!missing.empty() && attempt.judgement.verdict != Verdict::kDoesNotHold)
      attempt.judgement = {Verdict::kCannotBeDecided, "no rows: " + missing, {}, {}, 0, {}, {}, 0};
  }
  attempt.size = pattern;
  attempt.has_rows = !rows.empty();
  if (attempt.judgement.verdict == Verdict::kCannotBeDecided)
    attempt.judgement.reason += why_skipped(chosen.skipped);
  return attempt;
}

// The attempt of the largest weight decides. A size that lacks rows does not decide, unless rows of it
// failed. A size of few rounds that agree with the claim decides only if no other size does.
int weight_of(const Attempt& attempt) {
  switch (attempt.judgement.verdict) {
    case Verdict::kDoesNotHold:
      return 6;
    case Verdict::kNotResolved:
      return attempt.agrees_on_few_rounds ? 2 : 4;
    case Verdict::kHolds:
      return 3;
    case Verdict::kCannotBeDecided:
      break;
  }
  return attempt.has_failed_rows ? 5 : attempt.has_rows ? 1 : 0;
}

bool is_set_aside(const Attempt& attempt, const Attempt& decisive) {
  return attempt.agrees_on_few_rounds && attempt.judgement.verdict == Verdict::kNotResolved &&
         decisive.judgement.verdict == Verdict::kHolds;
}

// Combines the judgements at all sizes.
Judgement conclude(const Claim& claim, const std::vector<Attempt>& attempts) {
  const Attempt& decisive =
      *std::max_element(attempts.begin(), attempts.end(), [](const Attempt& a, const Attempt& b) {
        return std::pair(weight_of(a), a.excess) < std::pair(weight_of(b), b.excess);
      });
  Judgement judgement = decisive.judgement;
  if (judgement.verdict == Verdict::kCannotBeDecided) return judgement;
  judgement.num_rows = 0;
  std::vector<std::string> aside;
  for (const Attempt& attempt : attempts) {
    if (attempt.judgement.verdict == Verdict::kCannotBeDecided) continue;
    if (is_set_aside(attempt, decisive)) {
      aside.push_back(attempt.size);
      continue;
    }
    judgement.num_rows += attempt.judgement.num_rows;
    if (!attempt.size.empty()) judgement.sizes.push_back(attempt.size);
  }
  if (claim.trials.size() > 1)
    judgement.reason = fmt::format("{}: {}; judged at {}", decisive.size, judgement.reason,
                                   fmt::join(judgement.sizes, ", "));
  if (!aside.empty()) judgement.reason += fmt::format("; too few rounds: {}", fmt::join(aside, ", "));
  return judgement;
}

}  // namespace

Judgement judge(const Claim& claim, const std::vector<Row>& rows) {
  std::vector<Attempt> attempts;
  for (const std::string& pattern : claim.trials.empty() ? std::vector<std::string>{""} : claim.trials)
    attempts.push_back(judge_size(claim, rows, pattern));
  return conclude(claim, attempts);
}

}  // namespace podm::bench
