#include "cli/options/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/build_info.h"
#include "cli/options/add_options.h"
#include "cli/options/nearest_name.h"
#include "cli/options/options_json.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

constexpr int kHelpColumn = 30;

// Prints only the type beside an option's name. The description contains the rest.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string type = option->get_type_name();
    return type.empty() ? "" : " " + type;
  }
};

CLI::Option* add_value(CLI::App& app, const std::string& names, const std::string& type,
                       const std::string& description, const Setter& set) {
  const std::string name = names.substr(names.rfind(',') + 1);
  const auto set_all = [set, name](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) set(text, name);
  };
  CLI::Option* option = app.add_option_function<std::vector<std::string>>(names, set_all, description);
  return option->type_name(type)->type_size(1)->allow_extra_args(false);
}

}  // namespace

CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description) {
  return *program.add_subcommand(name, description);
}

void begin_group(CLI::App& app, const std::string& title) { app.option_defaults()->group(title); }

CLI::Option* add_one(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& description, const Target& target) {
  const std::string ending = target.default_value.empty() ? "" : " [default: " + target.default_value + "]";
  return add_value(app, names, type, description + ending, target.set)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
}

CLI::Option* add_many(CLI::App& app, const std::string& names, const std::string& type,
                      const std::string& description, const Setter& set) {
  CLI::Option* option = add_value(app, names, type, description, set);
  return option->get_positional() ? option->expected(-1) : option;  // an option takes one value each time
}

CLI::Option* add_flag(CLI::App& app, const std::string& names, bool& target, const std::string& description) {
  return app.add_flag(names, target, description);
}

void need_in_group(CLI::App& app, const std::string& title, CLI::Option* other) {
  for (CLI::Option* option : app.get_options([&](const CLI::Option* o) { return o->get_group() == title; }))
    option->needs(other);
}

void add_refusal(CLI::App& app, const std::string& names, const std::string& message) {
  const auto refuse = [message](const std::vector<std::string>&) { throw InputError(message); };
  app.add_option_function<std::vector<std::string>>(names, refuse)->expected(0, 1);
}

void end_help(CLI::App& app, const std::string& text) { app.footer(text); }
void require(CLI::Option* option) { option->required(); }

void exclude(CLI::Option* option, CLI::Option* other) { option->excludes(other); }
void need(CLI::Option* option, CLI::Option* other) { option->needs(other); }

namespace {

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

// Refuses unknown words. CLI11 leaves them aside, so that the message can name the nearest known word.
void refuse_unknown(CLI::App& program) {
  const auto commands = names_of_commands(program);
  const auto chosen = program.get_subcommands();
  CLI::App& app = chosen.empty() ? program : *chosen.front();
  const std::string called = program.get_name() + (chosen.empty() ? "" : " " + app.get_name());
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

Command parse_command_line(std::vector<std::string> arguments, Program which) {
  MeshCommand mesh;
  ReplayCommand replay;
  ConvertCommand convert;
  InfoCommand info;
  PhantomCommand phantom;
  ViewCommand view;
  ServeCommand serve;
  const std::string name = which == Program::kPodmMpi ? "podm-mpi" : "podm";
  CLI::App program("Tetrahedral meshes with guarantees from segmented images.", name);
  program.formatter(std::make_shared<HelpFormatter>());
  program.get_formatter()->column_width(kHelpColumn);
  program.set_help_flag("-h,--help", "print this help and exit");
  program.set_version_flag("--version", name + " " PODM_VERSION "\n" + build_info() + "\n",
                           "print the version and exit");
  program.allow_extras()->require_subcommand(0, 1);
  program.footer(
      "Exit codes: 0 success, 1 a guarantee or limit is unmet, 2 bad usage or input, 3 internal error.");
  if (which == Program::kPodmMpi) mesh.meshing.team.seed = mesh.meshing.cut_seed;
  add_mesh_command(program, mesh, which);
  if (which == Program::kPodmMpi) add_replay_on_ranks_command(program, replay);
  if (which == Program::kPodm) {
    add_replay_command(program, replay);
    add_convert_command(program, convert);
    add_info_command(program, info);
    add_phantom_command(program, phantom);
    add_view_command(program, view);
    add_serve_command(program, serve);
    add_options_command(program);
  }
  try {
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes arguments from the back
    program.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    return ShowText{program.help()};
  } catch (const CLI::CallForVersion& version) {
    return ShowText{version.what()};
  } catch (const CLI::Error& error) {
    refuse_unknown(program);  // a misspelt option also looks like a missing option
    fail_usage(error.what(), name + " " + program.get_subcommands().front()->get_name());
  }
  refuse_unknown(program);
  const std::string chosen = program.get_subcommands().front()->get_name();
  mesh.verify = mesh.verify || mesh.verify_fidelity;
  if (which == Program::kPodmMpi) mesh.meshing.cut_seed = mesh.meshing.team.seed;
  if (chosen == "mesh") return mesh;
  if (chosen == "replay") return replay;
  if (chosen == "convert") return convert;
  if (chosen == "info") return info;
  if (chosen == "view") return view;
  if (chosen == "serve") return serve;
  if (chosen == "options") return ShowText{options_json() + "\n"};
  return phantom;
}

}  // namespace podm::cli
