// Declaration of options: one line per option, which takes text and stores a checked value. Only options.cpp
// includes CLI11, because each source that includes it takes seconds to compile.
#pragma once

#include <string>

#include "cli/options/option_values.h"
#include "cli/options/options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace podm::cli {

/// Adds a command to the program. Options belong to the group of the last begin_group().
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description);
void begin_group(CLI::App& app, const std::string& title);
void end_help(CLI::App& app, const std::string& text);

/// Adds an option or argument with one value, given once or, with add_many, any number of times. The help
/// text ends with the target's default, if there is one.
CLI::Option* add_one(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& description, const Target& target);
CLI::Option* add_many(CLI::App& app, const std::string& names, const std::string& type,
                      const std::string& description, const Setter& set);
CLI::Option* add_flag(CLI::App& app, const std::string& names, bool& target, const std::string& description);
void require(CLI::Option* option);
/// The heading of a group in the help.
const char* title_of(OptionGroup group);

/// An option that is known and refused, with this message.
void add_refusal(CLI::App& app, const std::string& names, const std::string& message);
void exclude(CLI::Option* option, CLI::Option* other);
/// Allows `option` only together with `other`.
void need(CLI::Option* option, CLI::Option* other);

/// Allows all options of a group only together with `other`.
void need_in_group(CLI::App& app, const std::string& title, CLI::Option* other);

void add_image_argument(CLI::App& app, ImageArguments& image);
/// IMAGE and the labels that are kept.
void add_image_options(CLI::App& app, ImageArguments& image);
/// Adds only the options that select labels.
void add_label_options(CLI::App& app, ImageArguments& image);
/// Adds the options for the format of a mesh file that its extension leaves open.
void add_mesh_file_options(CLI::App& app, MeshFileOptions& options);
/// Adds the options of `podm mesh` that influence a plan; all of them need `plan`.
void add_planned_options(CLI::App& app, MeshCommand& command, CLI::Option* plan);
void add_mesh_command(CLI::App& program, MeshCommand& command, Program which);
void add_replay_command(CLI::App& program, ReplayCommand& command);
void add_replay_on_ranks_command(CLI::App& program, ReplayCommand& command);
void add_options_command(CLI::App& program);
void add_convert_command(CLI::App& program, ConvertCommand& command);
void add_info_command(CLI::App& program, InfoCommand& command);
void add_phantom_command(CLI::App& program, PhantomCommand& command);
void add_serve_command(CLI::App& program, ServeCommand& command);
void add_view_command(CLI::App& program, ViewCommand& command);

}  // namespace podm::cli
