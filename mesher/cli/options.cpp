#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>

#include "cli/nearest_name.h"
#include "cli/option_values.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

constexpr std::uint64_t kMaxThreads = 1024;
constexpr int kMaxPhantomSize = 4096;
constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;
constexpr int kHelpColumn = 30;

// What stands beside an option's name in the help: its type alone. The description tells the rest.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string type = option->get_type_name();
    return type.empty() ? "" : " " + type;
  }
};

// An option taking one value, given once or, when `many`, any number of times; `take(text, name)` stores it.
template <class Take>
CLI::Option* add_value(CLI::App& app, const std::string& names, const std::string& type, bool many,
                       const std::string& description, Take take) {
  const std::string name = names.substr(names.rfind(',') + 1);
  auto take_all = [take, name](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) take(text, name);
  };
  CLI::Option* option = app.add_option_function<std::vector<std::string>>(names, take_all, description);
  option->type_name(type)->type_size(1)->allow_extra_args(false);
  if (!many) option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  return option;
}

template <class Take>
CLI::Option* add_one(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& description, Take take) {
  return add_value(app, names, type, false, description, take);
}

template <class Take>
CLI::Option* add_many(CLI::App& app, const std::string& names, const std::string& type,
                      const std::string& description, Take take) {
  return add_value(app, names, type, true, description, take);
}

auto into(std::string& target) {
  return [&target](const std::string& text, const std::string& name) {
    if (text.empty()) throw InputError(name + ": the name of a file is empty");
    target = text;
  };
}

auto into_length(double& target_mm) {
  return [&target_mm](const std::string& text, const std::string& name) {
    target_mm = parse_positive(text, name, "length in mm");
  };
}

auto into_count(std::uint64_t& target) {
  return [&target](const std::string& text, const std::string& name) {
    target = parse_integer(text, name, 1, std::numeric_limits<std::uint32_t>::max());
  };
}

void add_image_options(CLI::App& app, ImageArguments& image) {
  add_one(app, "IMAGE", "",
          fmt::format("NIfTI, NRRD, MetaImage or INR label image, or phantom:NAME[@SIZE],\n"
                      "NAME one of {}",
                      fmt::join(phantom_names(), ", ")),
          into(image.path))
      ->required();
  app.option_defaults()->group("Labels");
  add_one(app, "--labels", "RANGES", "keep these label values only, e.g. 1,3-7 [default: all]",
          [&image](const std::string& text, const std::string& name) {
            image.selection.keep = parse_label_ranges(text, name);
          });
  add_one(app, "--drop", "RANGES", "turn these label values into background [default: none]",
          [&image](const std::string& text, const std::string& name) {
            image.selection.drop = parse_label_ranges(text, name);
          });
  add_many(app, "--merge", "VALUES=NAME",
           "make one label of several, e.g. 2,3=kidney; repeatable [default: none]",
           [&image](const std::string& text, const std::string&) {
             image.selection.merges.push_back(parse_merge(text));
           });
  add_one(app, "--background", "VALUE", "label value of the background [default: 0]",
          [&image](const std::string& text, const std::string& name) {
            image.selection.background = static_cast<std::uint32_t>(
                parse_integer(text, name, 0, std::numeric_limits<std::uint32_t>::max()));
          });
  add_one(app, "--label-names", "FILE",
          "names of labels: an ITK-SNAP table or lines \"value name\" [default: none]",
          into(image.label_names_path));
  app.option_defaults()->group("Options");
}

void add_sizing_options(CLI::App& app, MeshCommand& command) {
  MeshingOptions& meshing = command.meshing;
  app.option_defaults()->group("Size of the cells");
  CLI::Option* radius = add_one(app, "--radius", "MM",
                                "largest circumradius of a cell, mm [default: unbounded, the surface drives]",
                                into_length(meshing.radius_mm));
  add_many(app, "--radius-of", "LABEL=MM",
           "the same for one label, by name or value, e.g. liver=2;\nrepeatable [default: --radius]",
           [&command](const std::string& text, const std::string& name) {
             command.radius_of_mm.push_back(parse_label_length(text, name));
           });
  add_one(app, "--delta", "MM", "sampling distance of the surfaces, mm [default: from voxel size and radius]",
          into_length(meshing.delta_mm));
  add_one(app, "--target-elements", "N", "choose the radius for this many cells within 5 % [default: none]",
          into_count(meshing.target_elements))
      ->excludes(radius);
}

void add_limit_options(CLI::App& app, MeshCommand& command) {
  MeshingOptions& meshing = command.meshing;
  app.option_defaults()->group("Limits (a run that meets one writes a valid mesh and exits with 1)");
  add_one(app, "--max-elements", "N", "stop at this many cells [default: none]",
          into_count(meshing.max_elements));
  add_one(app, "--max-seconds", "S", "stop meshing after this many seconds [default: none]",
          [&meshing](const std::string& text, const std::string& name) {
            meshing.max_seconds = parse_positive(text, name, "number of seconds");
          });
  add_one(app, "--max-memory-gib", "GIB", "memory of the process, GiB [default: 80 % of what is available]",
          [&command](const std::string& text, const std::string& name) {
            const double bytes = parse_positive(text, name, "number of GiB") * kBytesPerGib;
            constexpr double kMost = 1e18;  // far above any machine, and within an integer
            command.max_memory_bytes = static_cast<std::uint64_t>(std::clamp(bytes, 1.0, kMost));
          });
}

void add_mesh_command(CLI::App& program, MeshCommand& command) {
  CLI::App& app = *program.add_subcommand("mesh", "mesh a label image into tetrahedra with guarantees");
  add_image_options(app, command.image);
  add_sizing_options(app, command);
  add_limit_options(app, command);
  app.option_defaults()->group("Output");
  add_one(app, "-o,--output", "MESH", "mesh file: .vtu, .mesh (medit) or .msh (Gmsh 4.1) [required]",
          into(command.mesh_path))
      ->required();
  add_one(app, "--surface", "FILE", "also the closed surface of each label: .stl or .ply [default: none]",
          into(command.surface_path));
  add_one(app, "--space", "SPACE",
          "frame of the coordinates: RAS or LPS (mm), or voxel (indices) [default: RAS]",
          [&command](const std::string& text, const std::string& name) {
            command.meshing.space = parse_space(text, name);
          });
  add_one(app, "--record", "FILE", "append one JSON line that describes the run [default: none]",
          into(command.record_path));
  app.option_defaults()->group("Run");
  add_one(app, "--threads", "N",
          "threads of all phases; 1 makes the same mesh every time\n"
          "[default: one for refinement, all cores for the feature transform]",
          [&command](const std::string& text, const std::string& name) {
            command.meshing.threads = static_cast<int>(parse_integer(text, name, 1, kMaxThreads));
          });
  add_one(
      app, "--contention", "MANAGER",
      "what a thread does that meets another's lock:\naggressive, random, global or local [default: local]",
      [&command](const std::string& text, const std::string& name) {
        command.meshing.contention = parse_contention(text, name);
      });
  app.add_flag("--verify", command.verify,
               "have podm-verify check the written mesh; exit 1 unless all holds [default: no]");
  app.add_flag("--quiet", command.quiet, "neither progress nor summary [default: both, on standard error]");
}

void add_info_command(CLI::App& program, InfoCommand& command) {
  CLI::App& app = *program.add_subcommand("info", "print size, spacing (mm), affine and labels of an image");
  add_image_options(app, command.image);
  app.add_flag("--json", command.json, "print one JSON object [default: text]");
}

void add_phantom_command(CLI::App& program, PhantomCommand& command) {
  CLI::App& app = *program.add_subcommand("phantom", "write an analytic phantom as a label image");
  add_one(app, "NAME", "", fmt::format("one of {}", fmt::join(phantom_names(), ", ")), into(command.name))
      ->required();
  add_one(app, "--size", "N", fmt::format("voxels along the longest axis [default: {}]", command.size),
          [&command](const std::string& text, const std::string& name) {
            command.size = static_cast<int>(parse_integer(text, name, 1, kMaxPhantomSize));
          });
  add_one(app, "-o,--output", "FILE", "NIfTI file: .nii or .nii.gz [required]", into(command.output_path))
      ->required();
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> names_of_commands(CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

[[noreturn]] void fail_usage(const std::string& fault, const std::string& program) {
  throw InputError(fmt::format("{}\nSee '{} --help'.", fault, program));
}

// CLI11 leaves aside what it does not know, so that the message can name the nearest known word.
void refuse_unknown(CLI::App& program) {
  const auto commands = names_of_commands(program);
  const auto chosen = program.get_subcommands();
  CLI::App& app = chosen.empty() ? program : *chosen.front();
  const std::string called = chosen.empty() ? "podm" : "podm " + app.get_name();
  if (const auto unknown = app.remaining(); !unknown.empty()) {
    std::string word = unknown.front().substr(0, unknown.front().find('='));
    if (word.starts_with('-'))
      fail_usage(fmt::format("unknown option '{}'{}", word, did_you_mean(word, names_of_options(app))),
                 called);
    if (!chosen.empty()) fail_usage(fmt::format("unexpected argument '{}'", unknown.front()), called);
    fail_usage(fmt::format("unknown command '{}'{}", word, did_you_mean(word, commands)), called);
  }
  if (chosen.empty())
    fail_usage(fmt::format("no command given, expected one of {}", fmt::join(commands, ", ")), called);
}

}  // namespace

Command parse_command_line(std::vector<std::string> arguments) {
  MeshCommand mesh;
  InfoCommand info;
  PhantomCommand phantom;
  CLI::App program("Tetrahedral meshes with guarantees from segmented images.", "podm");
  program.formatter(std::make_shared<HelpFormatter>());
  program.get_formatter()->column_width(kHelpColumn);
  program.set_help_flag("-h,--help", "print this help and leave");
  program.set_version_flag("--version", "podm " PODM_VERSION "\n", "print the version and leave");
  program.allow_extras()->require_subcommand(0, 1);
  program.footer(
      "Exit codes: 0 success, 1 a guarantee or limit is unmet, 2 bad usage or input, 3 internal error.");
  add_mesh_command(program, mesh);
  add_info_command(program, info);
  add_phantom_command(program, phantom);
  try {
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    program.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    return ShowText{program.help()};
  } catch (const CLI::CallForVersion& version) {
    return ShowText{version.what()};
  } catch (const CLI::Error& error) {
    refuse_unknown(program);  // a misspelt option also looks like one that is missing
    fail_usage(error.what(), "podm " + program.get_subcommands().front()->get_name());
  }
  refuse_unknown(program);
  const std::string chosen = program.get_subcommands().front()->get_name();
  if (chosen == "mesh") return mesh;
  if (chosen == "info") return info;
  return phantom;
}

}  // namespace podm::cli
