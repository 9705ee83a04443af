#include "experiments/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "options/option_keys.h"
#include "rows/machine_state.h"

namespace podm::bench {
namespace {

// Notes what a group lacks. A claim is not decided by the other groups while one group lacks rows.
void add_missing(Findings& findings, const std::string& what, const std::string& label) {
  if (findings.missing.empty()) findings.missing = label.empty() ? what : label + ": " + what;
  findings.has_failed_rows = findings.has_failed_rows || what.starts_with(kRowsFailed);
}

// True if rows of one series may differ in the option.
bool may_differ(const Claim& claim, const std::string& key) {
  return std::find(claim.across.begin(), claim.across.end(), key) != claim.across.end() ||
         (claim.value->per != nullptr && key == kTargetElements);
}

// Compares the number with the bounds.
Finding judge_number(const Bounds& bounds, const Estimate& estimate, const std::string& text,
                     const std::string& label, std::size_t num_rows) {
  return {decide(bounds, estimate),           estimate, bounds.excess(estimate.value),
          text + describe_interval(estimate), label,    num_rows};
}

std::string with_unit(double value, const Measure& measure) {
  return fmt::format("{:.4g}{}{}", value, *measure.unit == 0 ? "" : " ", measure.unit);
}

void judge_bound_of(const Claim& claim, const RowPointers& rows, const std::string& label,
                    Findings& findings) {
  const Samples samples = sample(rows, *claim.value);
  if (!samples.absence.empty()) return add_missing(findings, samples.absence, label);
  const Estimate estimate = estimate_of(samples);
  findings.found.push_back(judge_number(bounds_of(claim), estimate, with_unit(estimate.value, *claim.value),
                                        label, samples.num_rows));
}

// A measure that does not vary must hold for each row; any other for the median of its repeats.
void judge_bound(const Claim& claim, const RowPointers& rows, Findings& findings) {
  if (!varies(*claim.value)) {
    for (const Row* row : rows) judge_bound_of(claim, {row}, row->trial, findings);
    return;
  }
  const auto groups = group_rows(rows, [&](const std::string& key) { return may_differ(claim, key); });
  const auto labels = labels_of(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) judge_bound_of(claim, groups[i].rows, labels[i], findings);
}

// A trial that timed out while other work kept the machine busy may end in time on an idle machine.
std::string doubt_about(const Row& row, const Claim& claim) {
  const bool is_late = row.status == Status::kTimedOut && claim.value->meaning == Meaning::kOutcome;
  return is_late && is_disturbed(row) ? describe_disturbance(busy_elsewhere(row)) : "";
}

// Rows without an answer do not save a claim that the other rows refute: the claim fails if the share is too
// small even with all these rows counted as 1.
void judge_share(const Claim& claim, const RowPointers& rows, Findings& findings) {
  std::size_t num_yes = 0, num_open = 0;
  std::string absence, no, doubt;
  for (const Row* row : rows) {
    const Samples samples = sample({row}, *claim.value);
    if (!samples.absence.empty()) absence = samples.absence;
    const std::string doubt_of_row = samples.absence.empty() ? doubt_about(*row, claim) : "";
    if (!doubt_of_row.empty()) doubt = row->trial + ": " + doubt_of_row;
    if (!samples.absence.empty() || !doubt_of_row.empty()) {
      ++num_open;
    } else if (samples.middle() == 1) {
      ++num_yes;
    } else if (no.empty()) {
      no = ", not " + row->trial;
    }
  }
  const auto num_decided = static_cast<double>(rows.size() - num_open);
  const double most = static_cast<double>(num_yes + num_open) / static_cast<double>(rows.size());
  if (!absence.empty() && most >= *claim.at_least) return add_missing(findings, absence, "");
  Estimate share;
  share.value = num_decided > 0 ? static_cast<double>(num_yes) / num_decided : 0;
  Finding finding = judge_number(bounds_of(claim), share, fmt::format("{} of {}{}", num_yes, num_decided, no),
                                 "", rows.size());
  if (!doubt.empty() && most >= *claim.at_least) finding.decision = {Outcome::kNotResolved, doubt, {}, false};
  findings.found.push_back(std::move(finding));
}

// The samples of one side of a comparison, and the label that distinguishes them within the group.
struct Side {
  Samples samples;
  std::string label;
};

std::vector<Side> sides_of(const RowPointers& rows, const Claim& claim,
                           const std::function<bool(const std::string&)>& is_free) {
  const auto groups = group_rows(rows, is_free);
  std::vector<Side> sides;
  const auto labels = labels_of(groups);
  for (std::size_t i = 0; i < groups.size(); ++i)
    sides.push_back({sample(groups[i].rows, *claim.value), labels[i]});
  return sides;
}

const Side& best_of(const std::vector<Side>& sides, Better better) {
  return *std::min_element(sides.begin(), sides.end(), [better](const Side& a, const Side& b) {
    return better == Better::kLess ? a.samples.middle() < b.samples.middle()
                                   : a.samples.middle() > b.samples.middle();
  });
}

Finding compare(const Claim& claim, const Side& of, const Side& over, const std::string& label) {
  std::string text =
      fmt::format("{:.4g} over {}", of.samples.middle(), with_unit(over.samples.middle(), *claim.value));
  if (claim.over_best && !over.label.empty()) text += fmt::format(" ({})", over.label);
  return judge_number(bounds_of(claim), ratio_of(of.samples, over.samples), text, label,
                      of.samples.num_rows + over.samples.num_rows);
}

// Compares ratios and orders within one group. The series of `of` are distinguished by the options that only
// `over` fixes, and vice versa: over = {threads = 1} is the base of the series of every number of threads.
void compare_series(const Claim& claim, const RowGroup& group, const std::string& label, Findings& findings) {
  RowPointers of_rows, over_rows;
  for (const Row* row : group.rows) {
    const Json options = options_of(*row);
    const bool is_of = matches(options, claim.of);
    const bool is_over = claim.over_best ? !is_of : matches(options, claim.over);
    if (is_over) over_rows.push_back(row);
    if (is_of && !is_over) of_rows.push_back(row);  // a series is not compared with itself
  }
  const auto is_free = [&](const std::string& key) { return may_differ(claim, key); };
  if (claim.over_best && over_rows.empty())
    return add_missing(findings, "no rows to compare with " + describe(claim.of), label);
  for (const auto& [filter, rows] : {std::pair(&claim.over, &over_rows), {&claim.of, &of_rows}}) {
    if (const std::string value = missing_value(*filter, *rows); !value.empty())
      return add_missing(findings, "no rows: " + value, label);
    if (rows->empty()) return add_missing(findings, "no rows: " + describe(*filter), label);
  }
  std::vector<Side> ofs = sides_of(of_rows, claim, is_free), overs = sides_of(over_rows, claim, is_free);
  for (auto* sides : {&ofs, &overs})
    std::erase_if(*sides, [&](const Side& side) {
      if (!side.samples.absence.empty()) add_missing(findings, side.samples.absence, label);
      return !side.samples.absence.empty();
    });
  if (overs.empty()) return;
  for (const Side& of : ofs) {
    std::string place = label;
    if (!of.label.empty()) place += (place.empty() ? "" : ", ") + of.label;
    if (claim.over_best) {
      findings.found.push_back(compare(claim, of, best_of(overs, claim.value->better), place));
      continue;
    }
    for (const Side& over : overs) findings.found.push_back(compare(claim, of, over, place));
  }
}

void judge_series(const Claim& claim, const RowPointers& rows, Findings& findings) {
  const auto groups = group_rows(rows, [&](const std::string& key) {
    return names(claim.of, key) || names(claim.over, key) || may_differ(claim, key);
  });
  const auto labels = labels_of(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) compare_series(claim, groups[i], labels[i], findings);
}

struct Place {
  double at = 0;  // value of the option
  Samples samples;
};

// Converts the factor of a step into the factor per doubling of the option.
Estimate per_doubling(Estimate step, double doublings) {
  const auto root = [doublings](double& factor) { factor = std::pow(factor, 1 / doublings); };
  root(step.value);
  if (step.interval) {
    root(step.interval->low);
    root(step.interval->high);
  }
  std::for_each(step.samples.begin(), step.samples.end(), root);
  return step;
}

// Judges the step from one value of the option to another. Without a factor the measure may stay equal over a
// step, but not from the first value to the last.
Finding judge_step(const Claim& claim, const Place& from, const Place& to, bool is_all,
                   const std::string& label) {
  const Estimate step = claim.grows ? ratio_of(to.samples, from.samples) : ratio_of(from.samples, to.samples);
  const bool has_factor = claim.factor_per_doubling > 0;
  const Bounds bounds{has_factor ? claim.factor_per_doubling : 1, {}, is_all && !has_factor};
  const std::string text = fmt::format("{:.4g} at {}={:g}, {:.4g} at {:g}", from.samples.middle(),
                                       claim.along, from.at, to.samples.middle(), to.at);
  return judge_number(bounds, per_doubling(step, std::log2(to.at / from.at)), text, label,
                      from.samples.num_rows + to.samples.num_rows);
}

void judge_trend_of(const Claim& claim, const RowGroup& group, const std::string& label, Findings& findings) {
  std::map<double, RowPointers> by_place;
  for (const Row* row : group.rows) {
    const Json place = option(options_of(*row), claim.along);
    if (place.is_number() && place > 0) by_place[place].push_back(row);
  }
  if (by_place.size() < 2)
    return add_missing(findings, fmt::format("needs two values of {}, has {}", claim.along, by_place.size()),
                       label);
  std::vector<Place> places;
  for (const auto& [at, rows] : by_place) {
    Place place{at, sample(rows, *claim.value)};
    if (place.samples.absence.empty())
      places.push_back(std::move(place));
    else
      add_missing(findings, place.samples.absence, label);
  }
  for (std::size_t i = 1; i < places.size(); ++i)
    findings.found.push_back(judge_step(claim, places[i - 1], places[i], places.size() == 2, label));
  if (places.size() > 2 && claim.factor_per_doubling == 0)
    findings.found.push_back(judge_step(claim, places.front(), places.back(), true, label));
}

void judge_trend(const Claim& claim, const RowPointers& rows, Findings& findings) {
  const auto groups =
      group_rows(rows, [&](const std::string& key) { return key == claim.along || may_differ(claim, key); });
  const auto labels = labels_of(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) judge_trend_of(claim, groups[i], labels[i], findings);
}

}  // namespace

Findings find(const Claim& claim, const RowPointers& rows) {
  Findings findings;
  switch (claim.kind) {
    case ClaimKind::kBound:
      judge_bound(claim, rows, findings);
      break;
    case ClaimKind::kShare:
      judge_share(claim, rows, findings);
      break;
    case ClaimKind::kTrend:
      judge_trend(claim, rows, findings);
      break;
    case ClaimKind::kRatio:
    case ClaimKind::kOrder:
      judge_series(claim, rows, findings);
      break;
  }
  return findings;
}

}  // namespace podm::bench
