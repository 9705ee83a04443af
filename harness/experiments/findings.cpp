#include "experiments/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "experiments/option_matrix.h"

namespace podm::bench {
namespace {

// A claim is not decided by the groups that there are while one lacks rows.
void lack(Findings& findings, const std::string& what, const std::string& label) {
  if (findings.missing.empty()) findings.missing = label.empty() ? what : label + ": " + what;
  findings.has_failed_rows = findings.has_failed_rows || what.starts_with(kRowsFailed);
}

// Whether rows of one series may differ in the option.
bool may_differ(const Claim& claim, const std::string& key) {
  return std::find(claim.across.begin(), claim.across.end(), key) != claim.across.end() ||
         (claim.value->per != nullptr && key == kTargetElements);
}

double beyond(const Claim& claim, double value) {
  const auto scale = [](double bound) { return bound == 0 ? 1 : std::abs(bound); };
  double excess = -std::numeric_limits<double>::infinity();
  if (claim.at_least) excess = std::max(excess, (*claim.at_least - value) / scale(*claim.at_least));
  if (claim.at_most) excess = std::max(excess, (value - *claim.at_most) / scale(*claim.at_most));
  return excess;
}

std::string with_unit(double value, const Measure& measure) {
  return fmt::format("{:.4g}{}{}", value, *measure.unit == 0 ? "" : " ", measure.unit);
}

void judge_bound_of(const Claim& claim, const RowPointers& rows, const std::string& label,
                    Findings& findings) {
  const Samples samples = sample(rows, *claim.value);
  if (!samples.absence.empty()) return lack(findings, samples.absence, label);
  const double value = samples.middle(), excess = beyond(claim, value);
  findings.found.push_back(
      {excess <= 0, value, excess, with_unit(value, *claim.value), label, samples.num_rows});
}

// What does not vary holds of each row; the rest of the median of its repeats.
void judge_bound(const Claim& claim, const RowPointers& rows, Findings& findings) {
  if (!varies(*claim.value)) {
    for (const Row* row : rows) judge_bound_of(claim, {row}, row->trial, findings);
    return;
  }
  const auto groups = group_rows(rows, [&](const std::string& key) { return may_differ(claim, key); });
  const auto labels = labels_of(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) judge_bound_of(claim, groups[i].rows, labels[i], findings);
}

// What rows that cannot tell might still say does not save a claim that the others refute.
void judge_share(const Claim& claim, const RowPointers& rows, Findings& findings) {
  std::size_t num_yes = 0, num_open = 0;
  std::string absence, no;
  for (const Row* row : rows) {
    const Samples samples = sample({row}, *claim.value);
    if (!samples.absence.empty()) {
      absence = samples.absence;
      ++num_open;
    } else if (samples.middle() == 1) {
      ++num_yes;
    } else if (no.empty()) {
      no = ", not " + row->trial;
    }
  }
  const double share = static_cast<double>(num_yes) / static_cast<double>(rows.size() - num_open);
  const double most = static_cast<double>(num_yes + num_open) / static_cast<double>(rows.size());
  if (num_open > 0 && most >= *claim.at_least) return lack(findings, absence, "");
  findings.found.push_back({share >= *claim.at_least, share, beyond(claim, share),
                            fmt::format("{} of {}{}", num_yes, rows.size() - num_open, no), "", rows.size()});
}

std::string interval_of(const SeriesRatio& compared) {
  if (!compared.has_interval) return "";
  return fmt::format(", 95 % interval {:.3g} to {:.3g}", compared.ratio.low, compared.ratio.high);
}

// The samples of one side of a comparison and what tells them from others of the group.
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
  const SeriesRatio compared = ratio_of(of.samples, over.samples);
  const double value = compared.ratio.value;
  const bool is_order = claim.kind == ClaimKind::kOrder;
  const double excess = is_order ? (value > 1 ? -(value - 1) : 1 - value) : beyond(claim, value);
  const bool holds = is_order ? value > 1 : excess <= 0;
  std::string text =
      fmt::format("{:.4g} over {}", of.samples.middle(), with_unit(over.samples.middle(), *claim.value));
  if (claim.over_best && !over.label.empty()) text += fmt::format(" ({})", over.label);
  return {
      holds, value, excess, text + interval_of(compared), label, of.samples.num_rows + over.samples.num_rows};
}

// Ratios and orders within one group. Series of `of` are told apart by what only `over` fixes, and the other
// way round: over = {threads = 1} is the base of the series of every number of threads.
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
    return lack(findings, "no rows to compare with " + describe(claim.of), label);
  for (const auto& [filter, rows] : {std::pair(&claim.over, &over_rows), {&claim.of, &of_rows}}) {
    if (const std::string value = missing_value(*filter, *rows); !value.empty())
      return lack(findings, "no rows: " + value, label);
    if (rows->empty()) return lack(findings, "no rows: " + describe(*filter), label);
  }
  std::vector<Side> ofs = sides_of(of_rows, claim, is_free), overs = sides_of(over_rows, claim, is_free);
  for (auto* sides : {&ofs, &overs})
    std::erase_if(*sides, [&](const Side& side) {
      if (!side.samples.absence.empty()) lack(findings, side.samples.absence, label);
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
  double at = 0;  // along the option
  Samples samples;
};

// Judges the step from one value of the option to another. Without a factor the measure may rest on a step,
// but not from the first value to the last.
Finding judge_step(const Claim& claim, const Place& from, const Place& to, bool is_all,
                   const std::string& label) {
  const SeriesRatio compared =
      claim.grows ? ratio_of(to.samples, from.samples) : ratio_of(from.samples, to.samples);
  const double value = std::pow(compared.ratio.value, 1 / std::log2(to.at / from.at));
  const double least = claim.factor_per_doubling > 0 ? claim.factor_per_doubling : 1;
  const bool holds = is_all && claim.factor_per_doubling == 0 ? value > 1 : value >= least;
  const std::string text =
      fmt::format("{:.4g} at {}={:g}, {:.4g} at {:g}{}", from.samples.middle(), claim.along, from.at,
                  to.samples.middle(), to.at, interval_of(compared));
  return {holds, value, (least - value) / least, text, label, from.samples.num_rows + to.samples.num_rows};
}

void judge_trend_of(const Claim& claim, const RowGroup& group, const std::string& label, Findings& findings) {
  std::map<double, RowPointers> by_place;
  for (const Row* row : group.rows) {
    const Json place = option(options_of(*row), claim.along);
    if (place.is_number() && place > 0) by_place[place].push_back(row);
  }
  if (by_place.size() < 2)
    return lack(findings, fmt::format("needs two values of {}, has {}", claim.along, by_place.size()), label);
  std::vector<Place> places;
  for (const auto& [at, rows] : by_place) {
    Place place{at, sample(rows, *claim.value)};
    if (place.samples.absence.empty())
      places.push_back(std::move(place));
    else
      lack(findings, place.samples.absence, label);
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
