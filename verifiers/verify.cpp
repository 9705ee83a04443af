#include "verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "report/reports.h"
#include "run_claims.h"

namespace podm::verify {
namespace {

constexpr const char* kClearLine = "\r\033[K";

}  // namespace

int verify(const Command& command, bool shows_progress) {
  const auto start = std::chrono::steady_clock::now();
  const Options& options = command.options;
  check_claims(options);
  const Inputs inputs = read_inputs(options);
  const std::vector<std::string> claims = chosen_claims(options, inputs.mesh);
  const std::vector<ClaimResult> results = run_claims(inputs, options, claims, [&](const std::string& claim) {
    if (shows_progress) fmt::print(stderr, "{}checking {} ...", kClearLine, claim);
  });
  if (shows_progress) fmt::print(stderr, "{}", kClearLine);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!command.quiet) {
    const std::string report = terminal_report(inputs, options, results, seconds);
    if (options.json_path == "-") {
      fmt::print(stderr, "{}", report);
    } else {
      write_text("-", report);
    }
  }
  if (!options.json_path.empty())
    write_text(options.json_path, json_report(inputs, options, results, seconds));
  if (!options.extract_bad_path.empty()) write_bad_cells(options.extract_bad_path, inputs.mesh, results);
  const auto passes = [](const ClaimResult& result) { return result.verdict == Verdict::kPass; };
  return std::all_of(results.begin(), results.end(), passes) ? kSuccess : kClaimNotMet;
}

}  // namespace podm::verify
