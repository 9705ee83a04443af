#include "gate/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "rows/codec.h"
#include "rows/machine_state.h"
#include "rows/order_statistics.h"
#include "rows/row_filter.h"

namespace podm::bench {
namespace {

using Rows = std::vector<Row>;
using Number = std::optional<double>;

constexpr double kNegligible = 1.02;

enum class Wanted { kLess, kMore, kNeither };

// A number of a row.
struct Metric {
  const char* name;
  Wanted wanted;
  bool is_work;  ///< with one thread the program alone decides it
  Number (*read)(const Row& row);
};

template <class T>
Number as_number(const std::optional<T>& number) {
  return number ? Number(static_cast<double>(*number)) : Number();
}

Number seconds(const Row& row) { return row.mesh ? Number(meshing_seconds(row.mesh->phases_s)) : Number(); }
Number cells_per_second(const Row& row) { return row.mesh ? row.mesh->cells_per_second : Number(); }
Number cells(const Row& row) { return row.mesh ? Number(row.mesh->cells) : Number(); }
// A mesher's record alone has no data about its process.
Number peak_bytes(const Row& row) {
  return row.process.peak_rss_bytes > 0 ? Number(row.process.peak_rss_bytes) : Number();
}

WorkRecord work_of(const Row& row) {
  return row.mesh ? row.mesh->counters.value_or(WorkRecord{}) : WorkRecord{};
}
template <std::optional<std::uint64_t> WorkRecord::*kMember>
Number work(const Row& row) {
  return as_number(work_of(row).*kMember);
}
Number insertions(const Row& row) {
  const auto by_rule = work_of(row).insertions;
  if (!by_rule) return {};
  double sum = 0;
  for (const auto& [rule, number] : *by_rule) sum += static_cast<double>(number);
  return sum;
}

constexpr std::array kMetrics{
    Metric{"seconds", Wanted::kLess, false, seconds},
    Metric{"cells/s", Wanted::kMore, false, cells_per_second},
    Metric{"peak bytes", Wanted::kLess, false, peak_bytes},
    Metric{"cells", Wanted::kNeither, true, cells},
    Metric{"insertions", Wanted::kLess, true, insertions},
    Metric{"removals", Wanted::kLess, true, work<&WorkRecord::removals>},
    Metric{"conflict tests", Wanted::kLess, true, work<&WorkRecord::conflict_tests>},
    Metric{"exact decisions", Wanted::kNeither, true, work<&WorkRecord::exact_decisions>},
    Metric{"cells created", Wanted::kLess, true, work<&WorkRecord::cells_created>},
};

// Rows of the same measurement.
struct Group {
  std::string name;
  Rows a, b;
};

// The key that rows of the same measurement share. A row without a mesh has no options; it takes the options
// of another row of its trial.
class Keys {
 public:
  explicit Keys(std::initializer_list<const Rows*> files) {
    for (const Rows* rows : files)
      for (const Row& row : *rows)
        if (row.mesh) settings_.emplace(trial(row), settings(row));
  }
  std::string of(const Row& row) const {
    if (row.mesh) return trial(row) + settings(row);
    const auto found = settings_.find(trial(row));
    return trial(row) + (found == settings_.end() ? "" : found->second);
  }

 private:
  static std::string trial(const Row& row) { return Json{row.trial, row.input.name}.dump(); }
  // A target number of cells replaces a radius that was found for it, as two meshers may reach the number
  // with different radii.
  static std::string settings(const Row& row) {
    Json options = row.mesh->options ? *row.mesh->options : Json::object();
    if (row.resolved) {
      for (const char* key : {"radius_mm", "delta_mm"}) options.erase(key);
      options["target_elements"] = row.resolved->target_elements;
    }
    const auto threads = row.mesh->threads.value_or(ThreadsRecord{});
    return Json{to_json(row.mesh->algorithm), options, to_json(row.mesh->seed), to_json(threads.asked)}
        .dump();
  }
  std::map<std::string, std::string> settings_;  // by trial
};

// Returns the trial, or the image if a mesher's record has no trial.
std::string name_of(const Row& row) { return row.trial.empty() ? row.input.name : row.trial; }

// Groups are in the order of `a`. Groups without a row of `b` are left out.
std::vector<Group> groups_of(const Rows& a, const Rows& b) {
  const Keys keys{&a, &b};
  std::vector<Group> groups;
  std::map<std::string, std::size_t> places;
  for (const Row& row : a) {
    const auto [found, is_new] = places.emplace(keys.of(row), groups.size());
    if (is_new) groups.push_back({name_of(row), {}, {}});
    groups[found->second].a.push_back(row);
  }
  for (const Row& row : b)
    if (const auto found = places.find(keys.of(row)); found != places.end())
      groups[found->second].b.push_back(row);
  std::erase_if(groups, [](const Group& group) { return group.b.empty(); });
  return groups;
}

bool names_its_machine(const Row& row) { return !is_simulated(row) && !row.environment.cpu.empty(); }

// Throws InputError unless one machine measured all rows.
void check_machines(const std::vector<Group>& groups) {
  const Row* first = nullptr;
  for (const Group& group : groups)
    for (const Rows* rows : {&group.a, &group.b})
      for (const Row& row : *rows) {
        if (!names_its_machine(row)) continue;
        if (first == nullptr) first = &row;
        if (!same_machine(*first, row))
          throw InputError(fmt::format("rows of two machines cannot be compared: {} and {}",
                                       machine_name(*first), machine_name(row)));
      }
}

// Returns the answer of a row, empty if it has none.
using ReadAnswer = std::function<std::string(const Row& row)>;

// Returns the distinct answers of the rows that have one.
std::set<std::string> answers(const Rows& rows, const ReadAnswer& read) {
  std::set<std::string> found;
  for (const Row& row : rows)
    if (const std::string answer = read(row); !answer.empty()) found.insert(answer);
  return found;
}

// Worse if every answer of A is `good` and B has another answer or none.
void add_verdict(const Group& group, const std::string& name, const ReadAnswer& read, const std::string& good,
                 Comparison& result) {
  const auto a = answers(group.a, read), b = answers(group.b, read);
  if (a == b) return;
  const bool is_worse = a == std::set{good};
  result.is_worse = result.is_worse || is_worse;
  result.text +=
      fmt::format("{}: {}: {} in A, {} in B{}\n", group.name, name, fmt::join(a, "/"),
                  b.empty() ? "none" : fmt::format("{}", fmt::join(b, "/")), is_worse ? ": WORSE" : "");
}

bool has_one_thread(const Group& group) {
  const auto& mesh = group.a.front().mesh;
  return mesh && mesh->threads && mesh->threads->used == 1;
}

std::string hash_of(const Row& row) { return row.mesh ? row.mesh->mesh_sha256.value_or("") : ""; }

ByName<Proof> verdicts_of(const Row& row) {
  return row.mesh ? row.mesh->verdicts.value_or(ByName<Proof>{}) : ByName<Proof>{};
}

void add_differences(const Group& group, Comparison& result) {
  add_verdict(
      group, "status", [](const Row& row) { return to_string(row.status); }, to_string(Status::kOk), result);
  std::set<std::string> claims;
  for (const Rows* rows : {&group.a, &group.b})
    for (const Row& row : *rows)
      for (const auto& [claim, verdict] : verdicts_of(row)) claims.insert(claim);
  for (const std::string& claim : claims) {
    const auto verdict_on = [&claim](const Row& row) {
      const ByName<Proof> verdicts = verdicts_of(row);
      const Proof* const verdict = verdicts.find(claim);
      return verdict == nullptr ? "" : to_string(*verdict);
    };
    add_verdict(group, "verdicts/" + claim, verdict_on, to_string(Proof::kPass), result);
  }
  if (has_one_thread(group) && answers(group.a, hash_of) != answers(group.b, hash_of))
    result.text += group.name + ": another mesh on one thread\n";
}

std::vector<double> values(const Rows& rows, const Metric& metric) {
  std::vector<double> found;
  for (const Row& row : rows)
    if (const auto value = metric.read(row)) found.push_back(*value);
  return found;
}

const char* judgement(const Interval& ratio, Wanted wanted) {
  if (wanted == Wanted::kNeither) return "";
  if (ratio.coverage < kConfidence) return "not resolved";
  const bool is_more = ratio.low > kNegligible, is_less = ratio.high < 1 / kNegligible;
  if (is_more || is_less) return is_more == (wanted == Wanted::kMore) ? "better" : "WORSE";
  return ratio.low >= 1 / kNegligible && ratio.high <= kNegligible ? "same" : "not resolved";
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
  Interval ratio = ratio_interval(b, a);
  if (metric.is_work && has_one_thread(group)) ratio.coverage = 1;  // each run repeats the number
  const std::string verdict = judgement(ratio, metric.wanted);
  result.is_worse = result.is_worse || verdict == "WORSE";
  result.text += fmt::format(" {:>8.3f}  [{:.3f}, {:.3f}]  {:>5.1f} %  {}\n", median_b / median_a, ratio.low,
                             ratio.high, 100 * ratio.coverage, verdict);
}

}  // namespace

Row row_of(const MeshRecord& record) {
  Row row;
  row.status = Status::kOk;
  if (record.input) row.input.name = record.input->path.value_or("");
  row.mesh = record;
  return row;
}

Rows read_record_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("cannot read {}", path));
  Rows rows;
  std::size_t line_number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    try {
      const Json json = Json::parse(line, nullptr, false);
      const bool is_row = json.is_object() && json.contains("trial");
      rows.push_back(is_row ? from_json<Row>(json) : row_of(from_json<MeshRecord>(json)));
    } catch (const FieldError& fault) {
      throw InputError(fmt::format("{}:{}: is not a record of a trial or of the mesher: {}", path,
                                   line_number, fault.what()));
    }
  }
  if (rows.empty()) throw InputError(fmt::format("{} holds no records", path));
  return rows;
}

Comparison compare(const Rows& a, const Rows& b) {
  const auto groups = groups_of(a, b);
  if (groups.empty()) throw InputError("no row of A measures the same as a row of B");
  check_machines(groups);
  Comparison result;
  for (const Group& group : groups) add_differences(group, result);
  result.text += fmt::format("{:<24} {:<16} {:>14} {:>14} {:>8}  interval, its coverage, verdict\n", "trial",
                             "median of", "A", "B", "B/A");
  for (const Group& group : groups)
    for (const Metric& metric : kMetrics) add_metric(group, metric, result);
  return result;
}

}  // namespace podm::bench
