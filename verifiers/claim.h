// The result of a claim's check. Each claim has one check_*.cpp and one ClaimResult, from which reports are
// made.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "mesh.h"

namespace podm::verify {

enum class Verdict { kPass, kFail, kNotRun };

std::string to_string(Verdict verdict);  ///< "pass", "fail", "not_run"
/// Returns the verdict on a claim that was checked: one violation refutes it.
inline Verdict verdict_on(std::uint64_t num_violations) {
  return num_violations == 0 ? Verdict::kPass : Verdict::kFail;
}

/// A place where a claim does not hold, or comes closest to not holding.
struct Witness {
  std::string statement{};           ///< the statement of the claim that it breaks: "no duplicate cells"
  std::vector<GlobalId> cells{};     ///< 0-based
  std::vector<GlobalId> vertices{};  ///< 0-based
  std::vector<Point> points{};       ///< points to look at
  double value = 0;                  ///< the measured quantity; larger `severity` is worse
  double severity = 0;
  LabelValue label = 0;

  template <class Stream>
  void transfer(Stream& stream) {
    stream(statement, cells, vertices, points, value, severity, label);
  }
};

/// Counts of values in equal bins over [low, high). Values outside go to the first or last bin.
struct Histogram {
  std::string name;  ///< "radius_edge_ratio"
  std::string unit;  ///< "", "degrees", "mm"
  double low = 0, high = 0;
  double minimum = 0, maximum = 0;  ///< extremes of all values
  std::vector<std::uint64_t> counts;

  template <class Stream>
  void transfer(Stream& stream) {
    stream(name, unit, low, high, minimum, maximum, counts);
  }
};

inline constexpr std::size_t kMaxWitnesses = 10;

struct ClaimResult {
  std::string claim;  ///< "radius_edge"
  Verdict verdict = Verdict::kNotRun;
  std::string reason;  ///< reason if not run; otherwise one line for the terminal: "0 of 2943112 cells at or
                       ///< over 1.93"
  std::string method;  ///< "interval filter, then exact rationals"
  std::uint64_t num_checked = 0;     ///< facts decided: cells, facets, pairs
  std::uint64_t num_exact = 0;       ///< facts that the filter left to exact arithmetic
  std::uint64_t num_violations = 0;  ///< of the claim; 0 exactly when the verdict is pass
  std::uint64_t num_warnings = 0;    ///< facts reported but not claimed, such as orphan vertices
  std::vector<Witness> worst;        ///< at most kMaxWitnesses, worst first; on a pass the closest calls
  /// Every cell in a violation, ascending, each once: for --extract-bad. On ranks each has its own cells.
  std::vector<GlobalId> bad_cells;
  std::vector<Histogram> histograms;
  double seconds = 0;  ///< wall time, filled by the caller

  /// Further numbers, by name with units: an object. Copies of a result share it.
  nlohmann::json& details() const { return *details_; }

 private:
  std::shared_ptr<nlohmann::json> details_ = empty_details();
  static std::shared_ptr<nlohmann::json> empty_details();
};

}  // namespace podm::verify
