// How options are declared: one line each, text in, a checked value stored. CLI11 itself is seen by
// options.cpp alone: each source that includes it compiles for seconds.
#pragma once

#include <string>

#include "cli/options/option_values.h"
#include "cli/options/options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace podm::cli {

/// A command of the program. Its options come in groups: those that follow begin_group.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description);
void begin_group(CLI::App& app, const std::string& title);
void end_help(CLI::App& app, const std::string& text);

/// An option or argument taking one value, given once or, add_many, any number of times. Help ends with the
/// target's default, if it has any.
CLI::Option* add_one(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& description, const Target& target);
CLI::Option* add_many(CLI::App& app, const std::string& names, const std::string& type,
                      const std::string& description, const Setter& set);
/// An option that takes one of a choice's names.
template <Named Choice>
CLI::Option* add_choice(CLI::App& app, const std::string& names, const std::string& description,
                        Choice& choice) {
  return add_one(app, names, type_of_choices<Choice>(), description, into_choice(choice));
}
CLI::Option* add_flag(CLI::App& app, const std::string& names, bool& target, const std::string& description);
void require(CLI::Option* option);
/// The heading of a group in the help.
const char* title_of(OptionGroup group);

/// An option that is known and refused, with this message.
void add_refusal(CLI::App& app, const std::string& names, const std::string& message);
void exclude(CLI::Option* option, CLI::Option* other);
/// `option` may be given only with `other`.
void need(CLI::Option* option, CLI::Option* other);

/// The same for all options of a group.
void need_in_group(CLI::App& app, const std::string& title, CLI::Option* other);

void add_image_argument(CLI::App& app, ImageArguments& image);
/// IMAGE and the labels that are kept.
void add_image_options(CLI::App& app, ImageArguments& image);
void add_label_options(CLI::App& app, ImageArguments& image);
/// How a mesh file is written, beside what its extension says.
void add_mesh_file_options(CLI::App& app, MeshFileOptions& options);
/// Of `podm mesh`, what a plan depends on; all of these need `plan`.
void add_planned_options(CLI::App& app, MeshCommand& command, CLI::Option* plan);
void add_mesh_command(CLI::App& program, MeshCommand& command, Program which);
void add_replay_command(CLI::App& program, ReplayCommand& command);
void add_options_command(CLI::App& program);
void add_convert_command(CLI::App& program, ConvertCommand& command);
void add_info_command(CLI::App& program, InfoCommand& command);
void add_phantom_command(CLI::App& program, PhantomCommand& command);
void add_view_command(CLI::App& program, ViewCommand& command);

}  // namespace podm::cli
