#include "cli/commands/verify_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cli/processes/child_process.h"
#include "cli/processes/own_program.h"
#include "files/temporary_file.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "run/facets_of_sides.h"

namespace podm::cli {
namespace {

std::string verifier_path() { return (folder_of_own_program() / "podm-verify").string(); }

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::string text_of(const Ranges& ranges) {
  std::vector<std::string> parts;
  for (const auto& [first, last] : ranges)
    parts.push_back(first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last));
  return fmt::format("{}", fmt::join(parts, ","));
}

// Returns the options for the image and the selection of its labels.
std::vector<std::string> image_options(const MeshRun& run, const std::function<std::string()>& write_image) {
  const ImageArguments& image = run.command.image;
  const LabelSelection& selection = image.selection;
  const std::string background = fmt::format("{}", selection.background);
  if (image.is_array || image.is_phantom()) return {"--image", write_image(), "--background", background};
  std::vector<std::string> options{"--image", image.path, "--background", background};
  if (!selection.keep.empty()) options.insert(options.end(), {"--labels", text_of(selection.keep)});
  if (!selection.drop.empty()) options.insert(options.end(), {"--drop", text_of(selection.drop)});
  if (!selection.layers.empty())
    options.insert(options.end(), {"--layers", fmt::format("{}", fmt::join(selection.layers, ","))});
  if (selection.drop_islands_mm3 > 0)
    options.insert(options.end(), {"--drop-islands", fmt::format("{}", selection.drop_islands_mm3)});
  for (const auto& [values, name] : selection.merges)
    options.insert(options.end(), {"--merge", fmt::format("{}={}", fmt::join(values, ","), name)});
  return options;
}

// Returns the verifier's value of a label. The verifier uses 0 for the background, and the background's value
// for a foreground label 0.
std::uint32_t called_by_verifier(std::uint32_t label, std::uint32_t background) {
  return label == 0 ? background : label == background ? 0 : label;
}

// Returns the bounds on circumradii; empty if there are none.
std::vector<std::string> size_options(const MeshRun& run) {
  std::vector<std::string> options;
  const auto add = [&](const char* name, const std::string& value) {
    options.insert(options.end(), {name, value});
  };
  const SizeOptions& sizes = run.options.sizes;
  const std::uint32_t background = run.command.image.selection.background;
  const auto text_of_side = [&](std::vector<std::uint32_t> labels) {
    for (std::uint32_t& label : labels) label = called_by_verifier(label, background);
    return fmt::format("{}", fmt::join(labels, "+"));
  };
  if (run.report.radius_mm > 0) add("--radius", fmt::format("{}", run.report.radius_mm));
  for (const auto& [label, radius] : sizes.radius_of_mm)
    add("--radius-of", fmt::format("{}={}", called_by_verifier(label, background), radius));
  if (const std::string& size_image = run.command.size_image_path; !size_image.empty()) {
    add("--size-image", size_image);
    if (const double factor = run.report.size_image_factor; factor != 1)
      add("--size-factor", fmt::format("{}", factor));
  }
  for (const InterfaceSize& near : sizes.near)
    add("--size-near", fmt::format("{},{}={}:{}", text_of_side(near.labels[0]), text_of_side(near.labels[1]),
                                   near.radius_mm, near.width_mm));
  if (sizes.grade > 0 && !options.empty()) add("--grade", fmt::format("{}", sizes.grade));
  return options;
}

}  // namespace

Judging judging_of(const MeshRun& run) {
  Judging judging{
      {"structure", "radius_edge", "boundary_angles", "conformity", "surface", "labels", "surface_vertices"},
      {"--delta", fmt::format("{}", run.report.delta_mm)}};
  const bool is_delaunay = !run.report.optimization && run.report.is_delaunay_when_turned.value_or(true);
  if (is_delaunay) judging.claims.push_back("delaunay");
  if (run.report.promised_dihedral_deg) judging.claims.push_back("dihedral");  // the file has the bounds
  if (run.report.topology) judging.claims.push_back("topology");
  if (run.report.facets_of_sides) judging.claims.push_back("box");  // the file promises it
  if (run.report.lines && run.report.lines->is_claimed()) judging.claims.push_back("lines");
  const std::vector<std::string> sizes = size_options(run);
  if (!sizes.empty()) judging.claims.push_back("size");
  if (run.command.verify_fidelity) judging.claims.push_back("fidelity");
  judging.options.insert(judging.options.end(), sizes.begin(), sizes.end());
  return judging;
}

std::vector<std::string> verifier_options(const MeshRun& run,
                                          const std::function<std::string()>& write_image) {
  const Judging judging = judging_of(run);
  std::vector<std::string> options{"--claims", fmt::format("{}", fmt::join(judging.claims, ","))};
  options.insert(options.end(), judging.options.begin(), judging.options.end());
  const auto image = image_options(run, write_image);
  options.insert(options.end(), image.begin(), image.end());
  return options;
}

namespace {

// Writes a phantom to `scratch`, with its labels selected.
std::vector<std::string> verifier_command(const MeshRun& run, std::optional<TemporaryFolder>& scratch) {
  std::vector<std::string> command{verifier_path(), run.command.mesh_path, "--json", "-"};
  if (run.command.quiet) command.push_back("--quiet");
  const auto options = verifier_options(run, [&] {
    const std::string path = scratch.emplace(run.command.mesh_path) / "image.nii.gz";
    write_nifti(run.image, path);
    return path;
  });
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

// The first option that gives sizes by place; empty where all sizes are those of labels.
std::string option_of_sizes_by_place(const MeshCommand& command) {
  if (!command.size_image_path.empty()) return "size-image";
  if (!command.size_near.empty()) return "size-near";
  return command.meshing.sizes.grade > 0 ? "grade" : "";
}

}  // namespace

void check_verifier(const MeshCommand& command) {
  const std::string& mesh_path = command.mesh_path;
  if (const std::string option = option_of_sizes_by_place(command);
      !option.empty() && command.meshing.space == Space::kVoxel)
    throw InputError(
        fmt::format("--verify: podm-verify does not check the sizes of --{} in --space voxel", option));
  if (mesh_path.ends_with(".xdmf") || mesh_path.ends_with(".vtkhdf"))
    throw InputError(fmt::format(
        "--verify: podm-verify does not read {}; it reads all other formats that podm writes", mesh_path));
  if (!can_be_run(verifier_path()))
    throw InputError(fmt::format("--verify: {} cannot be run", verifier_path()));
}

JsonPointer verify_mesh(const MeshRun& run, const SignalThread& signals) {
  if (signals.token().stop_requested()) return nullptr;
  std::optional<TemporaryFolder> scratch;
  const auto command = verifier_command(run, scratch);
  ChildProcess verifier(command, "--verify", signals);
  auto report = nlohmann::ordered_json::parse(verifier.read(signals), nullptr, false);
  if (report.is_object()) return std::make_shared<const nlohmann::ordered_json>(std::move(report));
  if (signals.token().stop_requested()) return nullptr;
  throw InputError(fmt::format("--verify: {} printed no report", command[0]));
}

}  // namespace podm::cli
