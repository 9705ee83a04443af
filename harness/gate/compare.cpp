#include "gate/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "rows/record.h"
#include "rows/statistics.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<Json>;

constexpr double kNegligible = 1.02;

std::optional<double> seconds(const Json& row, const char* phases) {
  return at(row, phases).is_object() ? std::optional<double>(meshing_seconds(row)) : std::nullopt;
}

enum class Better { kLess, kMore, kNeither };

// A number of a row.
struct Metric {
  const char* name;
  const char* place;
  Better better;
  bool is_work;  ///< decided by the program alone when it has one thread
  std::optional<double> (*read)(const Json& row, const char* place) = number_at;
};

constexpr std::array kMetrics{
    Metric{"seconds", "/phases_s", Better::kLess, false, seconds},
    Metric{"cells/s", "/cells_per_second", Better::kMore, false},
    Metric{"peak bytes", "/process/peak_rss_bytes", Better::kLess, false},
    Metric{"cells", "/cells", Better::kNeither, true},
    Metric{"insertions", "/counters/insertions", Better::kLess, true, sum_at},
    Metric{"removals", "/counters/removals", Better::kLess, true},
    Metric{"conflict tests", "/counters/conflict_tests", Better::kLess, true},
    Metric{"exact decisions", "/counters/exact_decisions", Better::kNeither, true},
    Metric{"cells created", "/counters/cells_created", Better::kLess, true},
};

// Rows that measure the same.
struct Group {
  std::string name;
  Rows a, b;
};

// A row's name for it; the path in a mesher's own record, which has no other.
Json image_of(const Json& row) {
  const Json name = at(row, "/input/name");
  return name.is_null() ? at(row, "/input/path") : name;
}

// What two rows that measure the same share. A row without a mesh does not tell its options: those of another
// row of its trial are taken.
class Keys {
 public:
  explicit Keys(std::initializer_list<const Rows*> files) {
    for (const Rows* rows : files)
      for (const Json& row : *rows)
        if (row.contains("options")) settings_.emplace(trial(row), settings(row));
  }
  std::string of(const Json& row) const {
    if (row.contains("options")) return trial(row) + settings(row);
    const auto found = settings_.find(trial(row));
    return trial(row) + (found == settings_.end() ? "" : found->second);
  }

 private:
  static std::string trial(const Json& row) { return Json{at(row, "/trial"), image_of(row)}.dump(); }
  // A radius that was found stands for a number of cells, which two meshers may reach by different ones.
  static std::string settings(const Json& row) {
    Json options = at(row, "/options");
    if (const Json elements = at(row, "/resolved/target_elements"); !elements.is_null()) {
      for (const char* key : {"radius_mm", "delta_mm"}) options.erase(key);
      options["target_elements"] = elements;
    }
    return Json{at(row, "/algorithm"), options, at(row, "/seed"), at(row, "/threads/asked")}.dump();
  }
  std::map<std::string, std::string> settings_;  // by trial
};

// The trial, or the image where a mesher's record has none.
std::string name_of(const Json& row) {
  const Json trial = at(row, "/trial"), image = image_of(row);
  return trial.is_string() ? trial : image.is_string() ? image : Json("");
}

// In the order of `a`; those without a row of `b` are left out.
std::vector<Group> groups_of(const Rows& a, const Rows& b) {
  const Keys keys{&a, &b};
  std::vector<Group> groups;
  std::map<std::string, std::size_t> places;
  for (const Json& row : a) {
    const auto [found, is_new] = places.emplace(keys.of(row), groups.size());
    if (is_new) groups.push_back({name_of(row), {}, {}});
    groups[found->second].a.push_back(row);
  }
  for (const Json& row : b)
    if (const auto found = places.find(keys.of(row)); found != places.end())
      groups[found->second].b.push_back(row);
  std::erase_if(groups, [](const Group& group) { return group.b.empty(); });
  return groups;
}

// The different answers at a place, those of rows without one left out.
std::set<std::string> answers(const Rows& rows, const std::string& place) {
  std::set<std::string> found;
  for (const Json& row : rows)
    if (const Json answer = at(row, place.c_str()); answer.is_string()) found.insert(answer);
  return found;
}

// Worse when A answers well each time and B does not.
void add_verdict(const Group& group, const std::string& place, const std::string& good, Comparison& result) {
  const auto a = answers(group.a, place), b = answers(group.b, place);
  if (a == b) return;
  const bool is_worse = a == std::set{good};
  result.is_worse = result.is_worse || is_worse;
  result.text +=
      fmt::format("{}: {}: {} in A, {} in B{}\n", group.name, place.substr(1), fmt::join(a, "/"),
                  b.empty() ? "none" : fmt::format("{}", fmt::join(b, "/")), is_worse ? ": WORSE" : "");
}

bool has_one_thread(const Group& group) { return at(group.a.front(), "/threads/used") == 1; }

void add_differences(const Group& group, Comparison& result) {
  add_verdict(group, "/status", "ok", result);
  std::set<std::string> claims;
  for (const Rows* rows : {&group.a, &group.b})
    for (const Json& row : *rows) {
      const Json verdicts = at(row, "/verdicts");
      for (const auto& [claim, verdict] : verdicts.items()) claims.insert(claim);
    }
  for (const std::string& claim : claims) add_verdict(group, "/verdicts/" + claim, "pass", result);
  if (has_one_thread(group) && answers(group.a, "/mesh_sha256") != answers(group.b, "/mesh_sha256"))
    result.text += group.name + ": another mesh on one thread\n";
}

std::vector<double> values(const Rows& rows, const Metric& metric) {
  std::vector<double> found;
  for (const Json& row : rows)
    if (const auto value = metric.read(row, metric.place)) found.push_back(*value);
  return found;
}

const char* judgement(const Ratio& ratio, Better better) {
  if (better == Better::kNeither) return "";
  const bool is_more = ratio.low > kNegligible, is_less = ratio.high < 1 / kNegligible;
  if (!is_more && !is_less) return "same";
  return is_more == (better == Better::kMore) ? "better" : "WORSE";
}

void add_metric(const Group& group, const Metric& metric, Comparison& result) {
  const auto a = values(group.a, metric), b = values(group.b, metric);
  if (a.empty() || b.empty()) return;
  const double median_a = median(a), median_b = median(b);
  result.text +=
      fmt::format("{:<24} {:<16} {:>14.6g} {:>14.6g}", group.name, metric.name, median_a, median_b);
  if (median_a <= 0 || median_b <= 0) {
    result.text += "  no ratio\n";
    return;
  }
  const Ratio ratio = ratio_of_medians(b, a, Sampling::kIndependent);
  result.text += fmt::format(" {:>8.3f}", ratio.value);
  if (!(metric.is_work && has_one_thread(group)) && std::min(a.size(), b.size()) < kFewestRepeats) {
    result.text += fmt::format("  no interval of {} and {} rows\n", a.size(), b.size());
    return;
  }
  const std::string verdict = judgement(ratio, metric.better);
  result.is_worse = result.is_worse || verdict == "WORSE";
  result.text += fmt::format("  [{:.3f}, {:.3f}]  {}\n", ratio.low, ratio.high, verdict);
}

}  // namespace

Rows read_record_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("cannot read {}", path));
  Rows rows;
  std::size_t line_number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    Json row = Json::parse(line, nullptr, false);
    if (!row.is_object() || name_of(row).empty())
      throw InputError(fmt::format("{}:{}: is no record of a trial or of the mesher", path, line_number));
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw InputError(fmt::format("{}:1: holds no rows", path));
  return rows;
}

Comparison compare(const Rows& a, const Rows& b) {
  const auto groups = groups_of(a, b);
  if (groups.empty()) throw InputError("no row of A measures what a row of B does");
  Comparison result;
  for (const Group& group : groups) add_differences(group, result);
  result.text += fmt::format("{:<24} {:<16} {:>14} {:>14} {:>8}  95 % interval\n", "trial", "median of", "A",
                             "B", "B/A");
  for (const Group& group : groups)
    for (const Metric& metric : kMetrics) add_metric(group, metric, result);
  return result;
}

}  // namespace podm::bench
