// podm-verify: proves or refutes claims about a tetrahedral mesh file.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>

#include "errors.h"
#include "parallel.h"
#include "report/reports.h"
#include "run_claims.h"

namespace podm::verify {
namespace {

constexpr const char* kClearLine = "\r\033[K";
constexpr int kSuccess = 0, kClaimNotMet = 1, kBadInput = 2, kInternal = 3;

struct Command {
  Options options;
  std::vector<std::string> radius_of, merges;
  std::string claims, space, labels, drop;
  bool quiet = false;
};

// Bounds are made into rationals, which have no NaN and no infinity.
CLI::Validator positive() {
  return {[](std::string& text) {
            double value = 0;
            const bool is_positive =
                CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return is_positive ? std::string() : fmt::format("'{}' is no positive, finite number", text);
          },
          "POSITIVE"};
}

CLI::Validator angle() {
  return {[](std::string& text) {
            double value = 0;
            const bool is_angle = CLI::detail::lexical_cast(text, value) && value >= 0 && value <= 60;
            return is_angle ? std::string() : fmt::format("'{}' is no angle of 0 to 60 degrees", text);
          },
          "0..60"};
}

// Those of `podm mesh`, for a mesh of a part of the image's labels.
void declare_selection(CLI::App& app, Command& command) {
  app.option_defaults()->group("Labels of the image that were meshed");
  CLI::Option* image = app.get_option("--image");
  app.add_option("--labels", command.labels, "these label values only, e.g. 1,3-7 [default: all]")
      ->needs(image);
  app.add_option("--drop", command.drop, "these label values are background [default: none]")->needs(image);
  app.add_option("--merge", command.merges,
                 "VALUES=NAME, one label of several, e.g. 2,3=kidney; repeatable [default: none]")
      ->allow_extra_args(false)
      ->needs(image);
  app.add_option("--background", command.options.selection.background,
                 "label value of the background, in mesh and image")
      ->capture_default_str();
  app.option_defaults()->group("Options");
}

void declare_options(CLI::App& app, Command& command) {
  Options& options = command.options;
  app.add_option("MESH", options.mesh_path, "VTU, legacy VTK, Medit, Gmsh 2.2 or 4.1, TetGen; also .gz")
      ->required();
  app.add_option("--image", options.image_path,
                 "the segmented image, for the claims labels, surface and fidelity");
  declare_selection(app, command);
  app.add_option("--schedule", options.schedule_path,
                 "leaf grid and schedule of a run, for the claim conformity");
  app.add_option("--claims", command.claims,
                 "claims to check, e.g. structure,delaunay [default: all whose inputs are given]");
  app.add_option("--radius-edge", options.radius_edge_bound, "bound of the radius-edge ratio")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--angle", options.angle_bound_deg, "bound of the angles of boundary facets, degrees")
      ->check(angle())
      ->capture_default_str();
  app.add_option("--radius", options.radius_mm, "bound of the circumradius, mm [default: none]")
      ->check(positive());
  app.add_option("--radius-of", command.radius_of, "LABEL=MM, the same for one label value; repeatable")
      ->allow_extra_args(false);
  app.add_option("--fidelity-voxels", options.fidelity_bound_voxels,
                 "bound of the claim fidelity, voxels: the image tells no less")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--delta", options.delta_mm,
                 "sampling distance that a PODM mesh was made with, mm:\nfidelity within 2 delta passes, too")
      ->check(positive());
  app.add_option("--space", command.space, "RAS, LPS or voxel [default: what the mesh file says]")
      ->check(CLI::IsMember({"RAS", "LPS", "voxel"}));
  app.add_option("--threads", options.threads, "[default: all cores]")->check(CLI::Range(1, 4096));
  app.add_option("--json", options.json_path, "write the report as JSON to this file, - for standard output");
  app.add_option("--extract-bad", options.extract_bad_path, "write the cells in violation to this .vtu file");
  app.add_flag("--quiet", command.quiet, "no report for people");
  app.set_version_flag("--version", "podm-verify " PODM_VERSION);
  app.footer(
      "Exit codes: 0 all claims pass, 1 some fail or could not be decided, 2 bad usage or input, 3 "
      "internal.");
}

// A report is never written over what it reports on.
void refuse_to_overwrite_inputs(const Options& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const std::string& output : {options.json_path, options.extract_bad_path})
    for (const std::string& input : {options.mesh_path, options.image_path, options.schedule_path})
      if (!output.empty() && !input.empty() && fs::equivalent(output, input, error))
        throw InputError(fmt::format("{}: is an input, and would be written over", output));
}

void finish_options(Command& command) {
  Options& options = command.options;
  options.threads = num_threads(options.threads);
  options.claims = CLI::detail::split(command.claims, ',');
  std::erase(options.claims, std::string());
  if (command.space == "RAS") options.space = Space::kRas;
  if (command.space == "LPS") options.space = Space::kLps;
  if (command.space == "voxel") options.space = Space::kVoxel;
  for (const std::string& text : command.radius_of) {
    const std::size_t equals = text.find('=');
    LabelValue label = 0;
    double radius = 0;
    if (equals == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, equals), label) ||
        !CLI::detail::lexical_cast(text.substr(equals + 1), radius) || !(radius > 0) || std::isinf(radius))
      throw InputError(fmt::format("--radius-of: '{}' is not LABEL=MM, as in 7=0.5", text));
    options.radius_of[label] = radius;
  }
  if (!command.labels.empty()) options.selection.keep = parse_label_ranges(command.labels, "--labels");
  if (!command.drop.empty()) options.selection.drop = parse_label_ranges(command.drop, "--drop");
  for (const std::string& text : command.merges) options.selection.merges.push_back(parse_merge(text));
  const std::string& bad = options.extract_bad_path;
  if (!bad.empty() && !bad.ends_with(".vtu"))
    throw InputError(fmt::format("--extract-bad: '{}' does not end in .vtu", bad));
  refuse_to_overwrite_inputs(options);
}

int verify(const Command& command) {
  const auto start = std::chrono::steady_clock::now();
  const Options& options = command.options;
  const std::vector<std::string> claims = chosen_claims(options);
  const Inputs inputs = read_inputs(options);
  const bool shows_progress = !command.quiet && isatty(STDERR_FILENO) != 0;
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

int main_or_throw(int argc, char** argv) {
  CLI::App app("Proves or refutes claims about a tetrahedral mesh file, exactly.", "podm-verify");
  Command command;
  declare_options(app, command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kSuccess : kBadInput;
  }
  finish_options(command);
  return verify(command);
}

int complain(const std::string& fault, int exit_code) {
  fmt::print(stderr, "podm-verify: {}\n", fault);
  return exit_code;
}

}  // namespace
}  // namespace podm::verify

int main(int argc, char** argv) {
  using namespace podm::verify;
  try {
    return main_or_throw(argc, argv);
  } catch (const InputError& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain("out of memory", kInternal);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kInternal);
  }
}
