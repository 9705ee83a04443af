#include "verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "agreement.h"
#include "report/reports.h"
#include "run_claims.h"

namespace podm::verify {
namespace {

constexpr const char* kClearLine = "\r\033[K";

// Leaves standard output to the JSON report if it goes there.
void print(const std::string& report, const Options& options) {
  if (options.json_path == "-") {
    fmt::print(stderr, "{}", report);
  } else {
    write_text("-", report);
  }
}

}  // namespace

int verify(const Command& command, Communication& ranks, const std::function<Mesh()>& read,
           bool shows_progress) {
  const auto start = std::chrono::steady_clock::now();
  const Options& options = command.options;
  do_on_all(ranks, [&] { check_claims(options); });
  expect_same_index(options, ranks);
  Mesh mesh = read();
  Inputs inputs;
  do_on_all(ranks, [&] { inputs = read_inputs(options, std::move(mesh)); });
  expect_same_inputs(inputs, options, ranks);
  const std::vector<std::string> claims = chosen_claims(options, inputs.mesh);
  const std::vector<ClaimResult> results = run_claims(inputs, options, claims, [&](const std::string& claim) {
    if (shows_progress) fmt::print(stderr, "{}checking {} ...", kClearLine, claim);
  });
  if (shows_progress) fmt::print(stderr, "{}", kClearLine);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<std::uint64_t> peaks = gather(ranks, peak_resident_bytes());
  const std::vector<BadCell> bad_cells =
      options.extract_bad_path.empty() ? std::vector<BadCell>{} : find_bad_cells(inputs.mesh, results);
  do_on_all(ranks, [&] {
    if (ranks.rank() != 0) return;
    if (!command.quiet) print(terminal_report(inputs, options, results, seconds), options);
    if (!options.json_path.empty())
      write_text(options.json_path, json_report(inputs, options, results, seconds,
                                                *std::max_element(peaks.begin(), peaks.end())));
    if (!options.extract_bad_path.empty()) write_bad_cells(options.extract_bad_path, bad_cells, results);
  });
  const auto passes = [](const ClaimResult& result) { return result.verdict == Verdict::kPass; };
  return std::all_of(results.begin(), results.end(), passes) ? kSuccess : kClaimNotMet;
}

}  // namespace podm::verify
