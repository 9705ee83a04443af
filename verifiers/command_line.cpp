#include "command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "build_info.h"
#include "errors.h"
#include "run_claims.h"

namespace podm::verify {
namespace {

// The command as typed, before finish_options().
struct TypedCommand : Command {
  std::vector<std::string> radius_of, size_near, merges;
  std::string claims, space, labels, drop, layers, box;
};

// Accepts positive, finite numbers only. Bounds are converted to rationals, which have no NaN and no
// infinity.
CLI::Validator positive() {
  return {[](std::string& text) {
            double value = 0;
            const bool is_positive =
                CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return is_positive ? std::string() : fmt::format("'{}' is not a positive, finite number", text);
          },
          ""};
}

CLI::Validator angle_from(double least, double most) {
  return {[=](std::string& text) {
            double value = 0;
            const bool is_angle = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return is_angle ? std::string()
                            : fmt::format("'{}' is not an angle of {} to {} degrees", text, least, most);
          },
          ""};
}

// Adds an option whose value help shows as `type`.
template <class Value>
CLI::Option* add_option(CLI::App& app, const char* name, const char* type, Value& value,
                        const std::string& description) {
  return app.add_option(name, value, description)->option_text(type);
}

const char* name_of(Program program) {
  return program == Program::kPodmVerify ? "podm-verify" : "podm-verify-mpi";
}

void declare_inputs(CLI::App& app, TypedCommand& command, Program program) {
  Options& options = command.options;
  add_option(app, "MESH", " ", options.mesh_path,
             program == Program::kPodmVerify
                 ? "VTU, PVTU, legacy VTK, Medit, Gmsh 2.2 or 4.1, TetGen, Abaqus, Exodus II;\nalso .gz"
                 : "PVTU, of which each rank reads some pieces")
      ->required();
  app.option_defaults()->group("Inputs");
  add_option(app, "--image", "FILE", options.image_path,
             "segmented image: NIfTI, NRRD, MetaImage or INR; for the claims labels,\n"
             "surface_vertices and fidelity, and to compare its topology with the mesh's");
  add_option(app, "--space", "RAS|LPS|voxel", command.space,
             "frame of the mesh's coordinates: RAS or LPS (mm), or voxel (indices)\n"
             "[default: as stated in its file, otherwise RAS]")
      ->check(CLI::IsMember({"RAS", "LPS", "voxel"}));
  add_option(app, "--schedule", "FILE", options.schedule_path,
             "leaf grid and schedule of a run, for the claim conformity [default: none]");
}

// Declares the options of `podm mesh` that select a part of the image's labels.
void declare_selection(CLI::App& app, TypedCommand& command) {
  app.option_defaults()->group("Selection of labels, as given to podm mesh");
  CLI::Option* image = app.get_option("--image");
  add_option(app, "--labels", "RANGES", command.labels,
             "keep only these label values, e.g. 1,3-7 [default: all]")
      ->needs(image);
  add_option(app, "--drop", "RANGES", command.drop, "turn these label values into background [default: none]")
      ->needs(image);
  add_option(app, "--merge", "VALUES=NAME", command.merges,
             "merge label values into the first, e.g. 2,3=kidney; repeatable [default: none]")
      ->allow_extra_args(false)
      ->needs(image);
  add_option(app, "--layers", "LAYERS", command.layers,
             "layers of a .seg.nrrd of 3D Slicer that are read, from bottom to top, e.g. 1,0\n"
             "[default: all, later segments above earlier ones]")
      ->needs(image);
  add_option(app, "--drop-islands", "MM3", command.options.selection.drop_islands_mm3,
             "components of a label below this volume, mm^3, join a neighbour [default: none]")
      ->check(positive())
      ->needs(image);
  add_option(app, "--background", "VALUE", command.options.selection.background,
             fmt::format("label value of the background in mesh and image; a foreground label 0 is then\n"
                         "reported as VALUE [default: {}]",
                         command.options.selection.background));
  add_option(app, "--smooth", "MM", command.options.smooth_mm,
             "width by which interfaces of the image were smoothed [default: as stated in the mesh file,\n"
             "otherwise none]")
      ->check(positive())
      ->needs(image);
}

void declare_box(CLI::App& app, TypedCommand& command) {
  add_option(app, "--box", "open|flat", command.box,
             "sides of the image's box, as given to podm mesh: flat ones end the labels in the planes of\n"
             "the outermost voxels' outer faces [default: as the file promises]")
      ->check(CLI::IsMember({"open", "flat"}))
      ->needs(app.get_option("--image"));
}

void declare_claims(CLI::App& app, TypedCommand& command) {
  Options& options = command.options;
  constexpr std::size_t kNamesPerLine = 6;
  std::string names;
  for (std::size_t i = 0; i < all_claims().size(); ++i)
    names += fmt::format("{}{}", i == 0 ? "" : i % kNamesPerLine == 0 ? ",\n" : ", ", all_claims()[i].name);
  app.option_defaults()->group("Claims and their bounds");
  add_option(
      app, "--claims", "NAMES", command.claims,
      fmt::format(
          "check only these, separated by commas [default: all whose inputs and bounds are given]:\n{}",
          names));
  add_option(
      app, "--radius-edge", "RATIO", options.radius_edge_bound,
      fmt::format("circumradius over shortest edge is below this [default: {}]", options.radius_edge_bound))
      ->check(positive());
  add_option(app, "--angle", "DEGREES", options.angle_bound_deg,
             fmt::format("angles of boundary and interface facets are above this [default: {}]",
                         options.angle_bound_deg))
      ->check(angle_from(0, 60));
  add_option(app, "--radius", "MM", options.radius_mm,
             "size: largest circumradius of a cell, mm [default: none]")
      ->check(positive());
  add_option(app, "--radius-of", "LABEL=MM", command.radius_of,
             "size: the same for one label value; repeatable [default: --radius]")
      ->allow_extra_args(false);
  CLI::Option* size_image =
      add_option(app, "--size-image", "FILE", options.size_image_path,
                 "size: local bounds, a volume of lengths in mm as given to podm mesh [default: none]");
  add_option(
      app, "--size-factor", "X", options.size_factor,
      fmt::format(
          "factor of these bounds; podm mesh records that of a target as size_image_factor [default: {}]",
          options.size_factor))
      ->check(positive())
      ->needs(size_image);
  CLI::Option* image = app.get_option("--image");
  add_option(app, "--size-near", "A,B=MM:WIDTH", command.size_near,
             "size: largest circumradius within WIDTH mm of the interface of labels A and B,\n"
             "given as values; 0 is background, + joins several values of a side; repeatable\n"
             "[default: none; WIDTH: MM]")
      ->allow_extra_args(false)
      ->needs(image);
  add_option(app, "--grade", "G", options.grade,
             "size: bounds of labels and local bounds grow by at most G mm per mm of distance,\n"
             "within a slack that the report states [default: no limit]")
      ->check(positive())
      ->needs(image);
  add_option(app, "--min-dihedral", "DEGREES", options.min_dihedral_deg,
             "dihedral: least dihedral angle of a cell [default: as the file promises]")
      ->check(angle_from(0, 90));
  add_option(app, "--max-dihedral", "DEGREES", options.max_dihedral_deg,
             "dihedral: largest dihedral angle of a cell [default: as the file promises]")
      ->check(angle_from(90, 180));
  add_option(
      app, "--fidelity-voxels", "VOXELS", options.fidelity_bound_voxels,
      fmt::format("95 % of the interfaces of mesh and image are within this of each other [default: {},\n"
                  "since the label may end anywhere between two voxels]",
                  options.fidelity_bound_voxels))
      ->check(positive());
  add_option(
      app, "--vertex-voxels", "VOXELS", options.vertex_bound_voxels,
      fmt::format("surface_vertices: the image's label changes within this of each vertex of boundary\n"
                  "and interfaces [default: {}]",
                  options.vertex_bound_voxels))
      ->check(positive());
  add_option(app, "--delta", "MM", options.delta_mm,
             "surface sampling distance of a PODM mesh: fidelity also passes within 2 delta, and\n"
             "labels reach as far, as its rules prove; podm mesh prints and records it\n"
             "[default: none]")
      ->check(positive());
  add_option(app, "--lines-delta", "MM", options.lines_delta_mm,
             "distance at which a mesh of podm mesh --lines samples lines; boundary_angles then has a\n"
             "weaker bound near lines [default: as the file promises]")
      ->check(positive());
}

void declare_report(CLI::App& app, TypedCommand& command, Program program) {
  Options& options = command.options;
  app.option_defaults()->group("Run and report");
  add_option(app, "--json", "FILE", options.json_path,
             "write the report as JSON, - for standard output; its schema is podm-verify/1");
  add_option(app, "--extract-bad", "FILE", options.extract_bad_path,
             "write the cells that violate a claim, and the claim, as .vtu");
  const bool is_on_ranks = program == Program::kPodmVerifyMpi;
  add_option(
      app, "--threads", "N", options.threads,
      is_on_ranks
          ? "threads of a rank; verdicts do not depend on it\n[default: cores of the machine / ranks on it]"
          : "verdicts do not depend on it [default: all cores]")
      ->check(CLI::Range(1, 4096));
  if (is_on_ranks)
    add_option(app, "--in-process", "N", command.ranks_in_process,
               "run N ranks as threads of one process, without mpirun [default: the processes of mpirun]")
        ->check(CLI::Range(1, 4096));
  app.add_flag("--quiet", command.quiet, "print no text report");
  app.set_version_flag("--version", fmt::format("{} {}\n{}", name_of(program), PODM_VERSION, build_info()));
}

void declare_options(CLI::App& app, TypedCommand& command, Program program) {
  declare_inputs(app, command, program);
  declare_selection(app, command);
  declare_box(app, command);
  declare_claims(app, command);
  declare_report(app, command, program);
  app.footer(
      "Exit codes: 0 all claims pass, 1 some fail or could not be decided, 2 bad usage or input, 3 "
      "internal error.");
}

// Throws if a report would overwrite one of its inputs.
void refuse_to_overwrite_inputs(const Options& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const std::string& output : {options.json_path, options.extract_bad_path})
    for (const std::string& input :
         {options.mesh_path, options.image_path, options.schedule_path, options.size_image_path})
      if (!output.empty() && !input.empty() && fs::equivalent(output, input, error))
        throw InputError(fmt::format("{}: is an input and would be overwritten", output));
}

void finish_options(TypedCommand& command) {
  Options& options = command.options;
  options.claims = CLI::detail::split(command.claims, ',');
  std::erase(options.claims, std::string());
  if (command.space == "RAS") options.space = Space::kRas;
  if (command.space == "LPS") options.space = Space::kLps;
  if (command.space == "voxel") options.space = Space::kVoxel;
  if (!command.box.empty()) options.is_box_flat = command.box == "flat";
  for (const std::string& text : command.radius_of) {
    const std::size_t equals = text.find('=');
    LabelValue label = 0;
    double radius = 0;
    if (equals == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, equals), label) ||
        !CLI::detail::lexical_cast(text.substr(equals + 1), radius) || !(radius > 0) || std::isinf(radius))
      throw InputError(fmt::format("--radius-of: '{}' is not LABEL=MM, as in 7=0.5", text));
    options.radius_of[label] = radius;
  }
  for (const std::string& text : command.size_near)
    options.interface_sizes.push_back(parse_interface_size(text));
  if (!command.labels.empty()) options.selection.keep = parse_label_ranges(command.labels, "--labels");
  if (!command.drop.empty()) options.selection.drop = parse_label_ranges(command.drop, "--drop");
  if (!command.layers.empty()) options.selection.layers = parse_layers(command.layers, "--layers");
  for (const std::string& text : command.merges) options.selection.merges.push_back(parse_merge(text));
  const std::string& bad = options.extract_bad_path;
  if (!bad.empty() && !bad.ends_with(".vtu"))
    throw InputError(fmt::format("--extract-bad: '{}' does not end in .vtu", bad));
  refuse_to_overwrite_inputs(options);
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv, Program program) {
  CLI::App app(program == Program::kPodmVerify
                   ? "Proves or refutes claims about a tetrahedral mesh file."
                   : "Proves or refutes claims about a tetrahedral mesh in pieces, on ranks.",
               name_of(program));
  TypedCommand command;
  declare_options(app, command, program);
  CommandLine line;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    line.exit_code = app.exit(error, out, err) == 0 ? kSuccess : kBadInput;
    line.out = out.str();
    line.err = err.str();
    return line;
  }
  finish_options(command);
  line.command = std::move(command);
  return line;
}

}  // namespace podm::verify
