#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/add_options.h"
#include "cli/build_info.h"
#include "cli/nearest_name.h"

namespace podm::cli {
namespace {

constexpr int kMaxPhantomSize = 4096;
constexpr int kHelpColumn = 30;

// What stands beside an option's name in the help: its type alone. The description tells the rest.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string type = option->get_type_name();
    return type.empty() ? "" : " " + type;
  }
};

}  // namespace

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

namespace {

void add_replay_command(CLI::App& program, ReplayCommand& command) {
  CLI::App& app = *program.add_subcommand(
      "replay", "carry out a run's logged operations on one thread and compare the mesh");
  add_image_options(app, command.image);
  add_one(app, "LOG", "", "what podm mesh --log wrote, with the same image and label options",
          into(command.log_path))
      ->required();
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
  ReplayCommand replay;
  InfoCommand info;
  PhantomCommand phantom;
  CLI::App program("Tetrahedral meshes with guarantees from segmented images.", "podm");
  program.formatter(std::make_shared<HelpFormatter>());
  program.get_formatter()->column_width(kHelpColumn);
  program.set_help_flag("-h,--help", "print this help and leave");
  program.set_version_flag("--version", std::string("podm " PODM_VERSION "\n") + build_info() + "\n",
                           "print the version and leave");
  program.allow_extras()->require_subcommand(0, 1);
  program.footer(
      "Exit codes: 0 success, 1 a guarantee or limit is unmet, 2 bad usage or input, 3 internal error.");
  add_mesh_command(program, mesh);
  add_replay_command(program, replay);
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
  if (chosen == "replay") return replay;
  if (chosen == "info") return info;
  return phantom;
}

}  // namespace podm::cli
