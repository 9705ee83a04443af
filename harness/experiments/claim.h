// The claims of an experiment, in a form that rows decide: the [[claims]] of experiments/*.toml. The format
// is in experiments/README.md; judge.h decides claims.
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

/// The numbers of threads that a claim is about.
enum class Extent {
  kAll,
  kOneSocket,    ///< at most the number of cores of a socket of the rows' machine
  kMostThreads,  ///< the largest number that has rows
};

struct Claim {
  std::string name;       ///< permanent id, unique among all experiments
  std::string place;      ///< "file:line:column" of the name
  std::string statement;  ///< the claim in one sentence
  std::string note;       ///< known reasons why it does or does not hold; may be empty
  Basis basis = Basis::kMeasured;
  std::vector<std::string> trials;  ///< patterns of stems, each judged as a size of its own; none: all rows
  Filter where;
  Extent extent = Extent::kAll;
  int needs_cores = 0;  ///< minimum number of cores of the rows' machine
  const Measure* value = nullptr;
  ClaimKind kind = ClaimKind::kBound;
  std::optional<double> at_least, at_most;  ///< bounds of the value, ratio or share
  Filter of, over;                          ///< the compared series; in an order `of` is the one above
  bool over_best = false;                   ///< `over` is the best of the rows that are not `of`
  std::vector<std::string> across;          ///< options that may differ within a group
  std::string along;                        ///< the option of a trend
  bool grows = false;                       ///< the trend grows; otherwise it falls
  double factor_per_doubling = 0;           ///< minimum of a trend; 0: any
  std::vector<std::string> supersedes;      ///< claims whose place it takes, "name" or "experiment:name"
  std::string reason;                       ///< why it supersedes them, or why it changed; may be empty
};

/// A claim that was withdrawn.
struct WithdrawnClaim {
  std::string name, place, statement, reason;
  std::string superseded_by;  ///< the claim that replaced it; may be empty
};

/// The options of one trial, and its name in the file.
struct ClaimedTrial {
  std::string stem;
  nlohmann::ordered_json options;
};

/// Reads one [[claims]]. Throws InputError "file:line:column: fault" on anything that is not exactly the
/// format, or that no row of these trials could ever match.
Claim read_claim(TomlSection& section, const std::vector<ClaimedTrial>& trials);

/// Reads one [[withdrawn]]. Throws as read_claim() does.
WithdrawnClaim read_withdrawn_claim(TomlSection& section);

/// "at least 0.9 and at most 1.1", "above 1", "falls by at least 1.4 per doubling".
std::string describe_bound(const Claim& claim);

}  // namespace podm::bench
