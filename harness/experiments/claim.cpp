#include "experiments/claim.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;
using Trials = std::vector<ClaimedTrial>;

constexpr const char* kBestOfOthers = "best of the others";
constexpr std::int64_t kMostCores = 1 << 20;

// Returns the index of the text at `key` among the words. If the key is optional and absent, returns the
// first index.
template <std::size_t size>
std::size_t read_word(TomlSection& section, const char* key, const std::array<const char*, size>& words,
                      bool is_needed = true) {
  const std::string text = is_needed ? section.text(key) : section.text(key, words[0]);
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end())
    section.fail(key, fmt::format("{} must be one of {}", key, fmt::join(words, ", ")));
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<std::string> read_texts(TomlSection& section, const char* key) {
  std::vector<std::string> texts;
  for (const TomlValue& text : section.values(key)) texts.push_back(text.text());
  return texts;
}

// Returns the trials that a claim is about. Throws if a pattern matches no trial.
Trials trials_of(const TomlSection& section, const std::vector<std::string>& patterns, const Trials& all) {
  if (patterns.empty()) return all;
  Trials chosen;
  for (const std::string& pattern : patterns) {
    const std::size_t before = chosen.size();
    for (const ClaimedTrial& trial : all)
      if (fnmatch(pattern.c_str(), trial.stem.c_str(), 0) == 0) chosen.push_back(trial);
    if (chosen.size() == before) section.fail("trials", fmt::format("no trial is called '{}'", pattern));
  }
  return chosen;
}

Json json_of(const TomlValue& value) {
  if (const auto* const text = value.as<std::string>()) return *text;
  if (const auto* const integer = value.as<std::int64_t>()) return *integer;
  if (const auto* const flag = value.as<bool>()) return *flag;
  return value.number();
}

// True for numbers of threads and copies, which depend on the machine. Any other value must be in the file.
bool depends_on_machine(const std::string& key) { return key.ends_with("threads") || key == "copies"; }

void refuse_unknown(const TomlValue& value, const Trials& trials) {
  const Json wanted = json_of(value);
  const auto asks = [&](const ClaimedTrial& trial) { return option(trial.options, value.key) == wanted; };
  if ((depends_on_machine(value.key) && wanted.is_number()) ||
      std::any_of(trials.begin(), trials.end(), asks))
    return;
  value.fail(fmt::format("no trial of the claim has {}", describe(value.key, wanted)));
}

// Throws at the value of `place_key` unless some trial has the option `key`.
void refuse_unknown_key(const TomlSection& section, const char* place_key, const std::string& key,
                        const Trials& trials) {
  const auto has = [&](const ClaimedTrial& trial) { return trial.options.contains(key); };
  if (std::none_of(trials.begin(), trials.end(), has))
    section.fail(place_key, fmt::format("no trial of the claim has the option '{}'", key));
}

Condition read_range(TomlSection& options, const std::string& key) {
  Condition condition{key, {}, {}, {}};
  TomlSection range = options.table(key);
  condition.at_least = range.number("at_least");
  condition.at_most = range.number("at_most");
  if (!condition.at_least && !condition.at_most)
    options.fail(key, fmt::format("{} needs at_least or at_most", key));
  range.done();
  return condition;
}

// Reads the table at `key`; returns nothing if it is absent.
Filter read_filter(TomlSection& section, const char* key, const Trials& trials) {
  Filter filter;
  if (!section.has(key)) return filter;
  TomlSection options = section.table(key);
  for (const std::string& name : options.keys()) {
    refuse_unknown_key(options, name.c_str(), name, trials);
    if (options.is_table(name)) {
      filter.push_back(read_range(options, name));
      continue;
    }
    Condition condition{name, {}, {}, {}};
    for (const TomlValue& value : options.values(name)) {
      refuse_unknown(value, trials);
      condition.values.push_back(json_of(value));
    }
    filter.push_back(std::move(condition));
  }
  if (filter.empty()) section.fail(key, fmt::format("{} names no option", key));
  return filter;
}

void read_bounds(TomlSection& section, Claim& claim) {
  claim.at_least = section.number("at_least");
  claim.at_most = section.number("at_most");
  if (!claim.at_least && !claim.at_most) section.fail("[[claims]] needs at_least or at_most");
  if (claim.at_least && claim.at_most && *claim.at_least > *claim.at_most)
    section.fail("at_most", "at_most is less than at_least");
}

// Reads the series of a ratio or an order. The kind of the claim names their keys.
void read_series(TomlSection& section, const Trials& trials, const char* of, const char* over, Claim& claim) {
  if (!section.has(of)) section.text(of);  // throws: the key is absent
  claim.of = read_filter(section, of, trials);
  if (section.is_table(over)) {
    claim.over = read_filter(section, over, trials);
    return;
  }
  if (section.text(over) != kBestOfOthers)
    section.fail(over, fmt::format("{} must be a table or \"{}\"", over, kBestOfOthers));
  claim.over_best = true;
}

void read_across(TomlSection& section, const Trials& trials, Claim& claim) {
  claim.across = read_texts(section, "across");
  if (claim.over_best && !claim.across.empty())
    section.fail("across",
                 fmt::format("across would merge the series among which \"{}\" chooses; name the options "
                             "that differ in the first series",
                             kBestOfOthers));
  for (const std::string& key : claim.across)
    if (key != kInput) refuse_unknown_key(section, "across", key, trials);
}

void read_trend(TomlSection& section, const Trials& trials, Claim& claim) {
  claim.along = section.text("along");
  refuse_unknown_key(section, "along", claim.along, trials);
  claim.grows = read_word(section, "direction", std::array{"falls", "grows"}) == 1;
  claim.factor_per_doubling = section.positive("factor_per_doubling", 0);
}

void read_share(TomlSection& section, Claim& claim) {
  claim.at_least = section.positive("at_least", 0);
  if (!section.has("at_least") || *claim.at_least > 1)
    section.fail("at_least", "a share needs at_least, up to 1");
  if (!is_yes_or_no(*claim.value))
    section.fail("value", fmt::format("{} is not 0 or 1 in each row", claim.value->name));
}

const Measure* read_measure(TomlSection& section, Basis basis) {
  const Measure* measure = find_measure(section.text("value"));
  if (measure == nullptr) {
    std::vector<const char*> names;
    for (const Measure& known : measures()) names.push_back(known.name);
    section.fail("value", fmt::format("value must be one of {}", fmt::join(names, ", ")));
  }
  if (!fits(*measure, basis))
    section.fail("value", fmt::format("{} means something else in rows of another basis than "
                                      "the claim's, {}",
                                      measure->name, to_string(basis)));
  return measure;
}

void read_kind(TomlSection& section, const Trials& trials, Claim& claim) {
  claim.kind = static_cast<ClaimKind>(
      read_word(section, "kind", std::array{"bound", "ratio", "order", "trend", "share"}));
  switch (claim.kind) {
    case ClaimKind::kBound:
      return read_bounds(section, claim);
    case ClaimKind::kRatio:
      read_bounds(section, claim);
      read_series(section, trials, "of", "over", claim);
      return read_across(section, trials, claim);
    case ClaimKind::kOrder:
      read_series(section, trials, "above", "below", claim);
      return read_across(section, trials, claim);
    case ClaimKind::kTrend:
      read_trend(section, trials, claim);
      return read_across(section, trials, claim);
    case ClaimKind::kShare:
      return read_share(section, claim);
  }
}

}  // namespace

Claim read_claim(TomlSection& section, const Trials& all_trials) {
  Claim claim;
  claim.name = section.text("name");
  claim.place = section.where("name");
  claim.statement = section.text("statement");
  claim.note = section.text("note", "");
  claim.basis = static_cast<Basis>(read_word(section, "basis", std::array{"measured", "simulated", "any"}));
  claim.trials = read_texts(section, "trials");
  const Trials trials = trials_of(section, claim.trials, all_trials);
  claim.where = read_filter(section, "where", trials);
  claim.extent = static_cast<Extent>(
      read_word(section, "extent", std::array{"all", "one socket", "most threads"}, false));
  if (claim.extent == Extent::kOneSocket && claim.basis != Basis::kMeasured)
    section.fail("extent", "rows do not record the sockets of a simulated machine");
  claim.needs_cores = static_cast<int>(section.count("needs_cores", 0, 1, kMostCores));
  if (claim.needs_cores > 0 && claim.basis != Basis::kMeasured)
    section.fail("needs_cores", "needs_cores applies to measured rows only");
  claim.value = read_measure(section, claim.basis);
  read_kind(section, trials, claim);
  claim.supersedes = read_texts(section, "supersedes");
  claim.reason = section.text("reason", "");
  if (!claim.supersedes.empty() && claim.reason.empty())
    section.fail("supersedes", "a claim that supersedes others needs a reason");
  section.done();
  return claim;
}

WithdrawnClaim read_withdrawn_claim(TomlSection& section) {
  WithdrawnClaim claim{section.text("name"), section.where("name"), section.text("statement"),
                       section.text("reason"), section.text("superseded_by", "")};
  section.done();
  return claim;
}

std::string describe_bound(const Claim& claim) {
  if (claim.kind == ClaimKind::kOrder) return "above 1";
  if (claim.kind == ClaimKind::kTrend) {
    const char* direction = claim.grows ? "grows" : "falls";
    return claim.factor_per_doubling > 0
               ? fmt::format("{} by at least {} per doubling", direction, claim.factor_per_doubling)
               : direction;
  }
  std::vector<std::string> parts;
  if (claim.at_least) parts.push_back(fmt::format("at least {}", *claim.at_least));
  if (claim.at_most) parts.push_back(fmt::format("at most {}", *claim.at_most));
  return fmt::format("{}", fmt::join(parts, " and "));
}

}  // namespace podm::bench
