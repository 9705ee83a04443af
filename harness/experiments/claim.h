// What an experiment claims, in a form that rows decide: the [[claims]] of experiments/*.toml. The format is
// in experiments/README.md, the judge in judge.h.
#pragma once

#include <string>
#include <vector>

#include "rows/measure.h"
#include "rows/row_filter.h"
#include "runtime/toml_section.h"

namespace podm::bench {

enum class ClaimKind {
  kBound,  ///< the value is within bounds in every group
  kRatio,  ///< the ratio of one series over another is within bounds
  kOrder,  ///< one series is above another
  kTrend,  ///< the value grows or falls along an option
  kShare,  ///< a share of the rows has the value 1
};

/// Which numbers of threads a claim is about.
enum class Extent {
  kAll,
  kOneSocket,    ///< at most as many as a socket of the rows' machine has cores
  kMostThreads,  ///< the largest number there are rows of
};

struct Claim {
  std::string name;       ///< its id for life, unique among all experiments
  std::string place;      ///< "file:line:column" of the name
  std::string statement;  ///< one sentence: what is claimed
  std::string note;       ///< what is known of why it does or does not hold; may be empty
  Basis basis = Basis::kMeasured;
  std::vector<std::string> trials;  ///< patterns of stems, the first with all it needs counts; none: all rows
  Filter where;
  Extent extent = Extent::kAll;
  int needs_cores = 0;  ///< the rows' machine needs to have
  const Measure* value = nullptr;
  ClaimKind kind = ClaimKind::kBound;
  std::optional<double> at_least, at_most;  ///< bounds of the value, ratio or share
  Filter of, over;                          ///< series compared; in an order `of` is the one above
  bool over_best = false;                   ///< `over` is the best of the rows that are not `of`
  std::vector<std::string> across;          ///< options that may differ within a group
  std::string along;                        ///< the option that a trend goes along
  bool grows = false;                       ///< the trend grows, or else it falls
  double factor_per_doubling = 0;           ///< the least of a trend; 0: any
  std::vector<std::string> supersedes;      ///< claims whose place it takes, "name" or "experiment:name"
  std::string reason;                       ///< why it does, or why it changed; may be empty
};

/// A claim that is no longer made.
struct WithdrawnClaim {
  std::string name, place, statement, reason;
  std::string superseded_by;  ///< the claim that took its place; may be empty
};

/// The options of one trial, and the name that the file gives it.
struct ClaimedTrial {
  std::string stem;
  nlohmann::ordered_json options;
};

/// Reads one [[claims]]. Throws InputError "file:line:column: fault" on anything that is not exactly the
/// format, or that no row of these trials could ever match.
Claim read_claim(TomlSection& section, const std::vector<ClaimedTrial>& trials);

/// Reads one [[withdrawn]]. Throws as read_claim() does.
WithdrawnClaim read_withdrawn_claim(TomlSection& section);

/// "at least 0.9 and at most 1.1", "above", "falls by at least 1.4 a doubling".
std::string describe_bound(const Claim& claim);

}  // namespace podm::bench
