#include "experiments/judge.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

#include "experiments/findings.h"

namespace podm::bench {
namespace {

// "3 of 4 hold; threads=256: 1.2 over 2.4 s".
std::string told(const Findings& findings, const Finding& worst) {
  const auto& found = findings.found;
  const auto is_same = [&](const Finding& other) { return other.text == worst.text; };
  if (worst.holds && found.size() > 1 && std::all_of(found.begin(), found.end(), is_same))
    return fmt::format("{} in each of {}", worst.text, found.size());
  const std::string text = worst.label.empty() ? worst.text : worst.label + ": " + worst.text;
  if (found.size() == 1) return text;
  if (worst.holds) return fmt::format("nearest of {}: {}", found.size(), text);
  const auto num_held =
      std::count_if(found.begin(), found.end(), [](const Finding& finding) { return finding.holds; });
  return fmt::format("{} of {} hold; {}", num_held, found.size(), text);
}

Judgement conclude(const Findings& findings) {
  const auto& found = findings.found;
  const auto worst = std::max_element(found.begin(), found.end(), [](const Finding& a, const Finding& b) {
    return std::pair(!a.holds, a.excess) < std::pair(!b.holds, b.excess);
  });
  Judgement judgement;
  for (const Finding& finding : found) judgement.num_rows += finding.num_rows;
  if (worst == found.end() || (worst->holds && !findings.missing.empty())) {
    judgement.reason = findings.missing;
    return judgement;
  }
  judgement.verdict = worst->holds ? Verdict::kHolds : Verdict::kDoesNotHold;
  if (std::isfinite(worst->value)) judgement.value = worst->value;
  judgement.reason = told(findings, *worst);
  return judgement;
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

// Why the rows' machine cannot decide the claim; empty: it can.
std::string lack_of_cores(const Claim& claim, const RowPointers& rows) {
  if (claim.needs_cores == 0) return "";
  const auto cores = cores_of(*rows.front());
  if (!cores) return "the rows do not tell how many cores their machine has";
  return *cores >= claim.needs_cores ? "" : fmt::format("needs {} cores, has {}", claim.needs_cores, *cores);
}

double threads_of(const Row& row) { return row.asked.value("threads", 1.0); }

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

// Why rows that were planned did not run.
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

struct Attempt {
  Judgement judgement;
  bool has_rows = false, has_failed_rows = false;
};

Attempt judge_pattern(const Claim& claim, const std::vector<Row>& all_rows, const std::string& pattern) {
  const Chosen chosen = choose(claim, all_rows, pattern);
  const RowPointers rows = within_extent(claim, chosen.rows);
  const auto undecided = [&](const std::string& reason) {
    return Attempt{
        {Verdict::kCannotBeDecided, reason + why_skipped(chosen.skipped), {}, 0}, !rows.empty(), false};
  };
  if (rows.empty())
    return undecided(pattern.empty() ? "no rows"
                                     : fmt::format("no rows: trial {}", fmt::join(claim.trials, " or ")));
  if (const std::string lack = lack_of_cores(claim, rows); !lack.empty()) return undecided(lack);
  if (const std::string value = missing_value(claim.where, rows); !value.empty())
    return undecided("no rows: " + value);
  const Findings findings = find(claim, rows);
  Attempt attempt{conclude(findings), true, findings.has_failed_rows};
  if (attempt.judgement.verdict == Verdict::kCannotBeDecided)
    attempt.judgement.reason += why_skipped(chosen.skipped);
  return attempt;
}

}  // namespace

std::string to_string(Verdict verdict) {
  return verdict == Verdict::kHolds         ? "holds"
         : verdict == Verdict::kDoesNotHold ? "does_not_hold"
                                            : "cannot_be_decided";
}

Judgement judge(const Claim& claim, const std::vector<Row>& rows) {
  std::vector<std::string> patterns = claim.trials;
  if (patterns.empty()) patterns.push_back("");
  std::optional<Attempt> told;  // by the largest size that has rows
  for (const std::string& pattern : patterns) {
    Attempt attempt = judge_pattern(claim, rows, pattern);
    // A size whose rows failed is not passed over for a smaller one that went well.
    if (attempt.judgement.verdict != Verdict::kCannotBeDecided || attempt.has_failed_rows)
      return attempt.judgement;
    if (!told || (attempt.has_rows && !told->has_rows)) told = std::move(attempt);
  }
  return told->judgement;
}

}  // namespace podm::bench
