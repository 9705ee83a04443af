// The commands whose options are declared beside their members (podm/option.h): podm mesh, podm info --plan,
// podm convert, podm serve.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "cli/options/add_options.h"

namespace podm::cli {
const char* title_of(OptionGroup group) {
  constexpr std::array kTitles{"Labels",
                               "Size of the cells",
                               "Surfaces",
                               "Dihedral angles",
                               "Limits (a run that reaches one writes a valid mesh and exits with 1)",
                               "Output",
                               "Algorithm",
                               "Run"};
  return kTitles[static_cast<std::size_t>(group)];
}

namespace {

template <class Value>
std::string type_of([[maybe_unused]] const Declaration& of) {
  if constexpr (Named<Value>) {
    return type_of_choices<Value>();
  } else if constexpr (std::same_as<Value, std::optional<GmshVersion>>) {
    return type_of_choices<GmshVersion>();
  } else {
    return of.type;
  }
}

std::string names_of(const Declaration& of) {
  return fmt::format("{}{}--{}", of.short_name ? of.short_name : "", of.short_name ? "," : "", of.name);
}

// The help with the default.
template <class Value>
std::string description_of(const Declaration& of, const Value& value, bool is_on_ranks) {
  const std::string help = is_on_ranks && of.help_on_ranks ? of.help_on_ranks : of.help;
  if (of.is_required) return help + "\n[required]";
  std::string unset = is_on_ranks && of.unset_on_ranks ? of.unset_on_ranks : of.unset;
  if (const std::string text = shown(value); unset.empty()) unset = text.empty() ? "0" : text;
  const std::size_t last_line = help.size() - (help.rfind('\n') + 1);  // of all of it, where there is no \n
  constexpr std::size_t kMostColumns = 80;
  const char* const separator =
      last_line + unset.size() + std::string(" [default: ]").size() > kMostColumns ? "\n" : " ";
  return fmt::format("{}{}[default: {}]", help, separator, unset);
}

template <class Value>
CLI::Option* add_declared(CLI::App& app, const Declaration& of, Value& value, bool is_on_ranks) {
  const std::string description = description_of(of, value, is_on_ranks);
  if constexpr (std::same_as<Value, bool>) {
    return add_flag(app, names_of(of), value, description);
  } else {
    const Setter set = [&value, of](const std::string& text, const std::string&) {
      parse_into(value, text, of);
    };
    if constexpr (kIsRepeatable<Value>)
      return add_many(app, names_of(of), type_of<Value>(of), description, set);
    return add_one(app, names_of(of), type_of<Value>(of), description, set);
  }
}

// The program knows the option, so that its refusal has the reason; help lists it apart.
void add_refused(CLI::App& app, const Declaration& of) {
  begin_group(app, "");
  add_refusal(app, names_of(of), fmt::format("--{} is not available on ranks: {}", of.name, of.not_on_ranks));
}

// Adds the declared options of the struct that have the use, group by group.
template <class Struct>
void add_declared_options(CLI::App& app, Struct& of, OptionUse use, const char* only_group = nullptr) {
  struct Added {
    Declaration of;
    std::function<CLI::Option*()> add;
  };
  std::vector<Added> options;
  const bool is_on_ranks = use == kOnRanks;
  for_each_option(of, [&](const Declaration& declared, auto& value) {
    if ((declared.uses & use) == 0) return;
    if (is_on_ranks && declared.not_on_ranks) return add_refused(app, declared);
    options.push_back({declared, [&app, &value, declared, is_on_ranks] {
                         return add_declared(app, declared, value, is_on_ranks);
                       }});
  });
  std::ranges::stable_sort(options, {}, [](const Added& added) { return added.of.group; });
  std::map<std::string, CLI::Option*> by_name;
  for (const Added& added : options) {
    begin_group(app, only_group ? only_group : title_of(added.of.group));
    by_name[added.of.name] = added.add();
    if (added.of.is_required) require(by_name[added.of.name]);
  }
  for (const Added& added : options) {
    if (added.of.needs) need(by_name.at(added.of.name), by_name.at(added.of.needs));
    if (added.of.excludes && by_name.contains(added.of.excludes))
      exclude(by_name.at(added.of.name), by_name.at(added.of.excludes));
  }
}

std::string refused_on_ranks(MeshCommand& command) {
  std::string text =
      "Not on ranks: --algorithm podm-home; zones are not divided into homes.\n"
      "Only on ranks in process: --executor virtual.\n";
  for_each_option(command, [&](const Declaration& of, auto&) {
    if (of.not_on_ranks) text += fmt::format("Not on ranks: --{}; {}.\n", of.name, of.not_on_ranks);
  });
  return text;
}

}  // namespace

void add_label_options(CLI::App& app, ImageArguments& image) { add_declared_options(app, image, kInPodm); }

void add_mesh_file_options(CLI::App& app, MeshFileOptions& options) {
  add_declared_options(app, options, kInPodm, "Options");
}

void add_mesh_command(CLI::App& program, MeshCommand& command, Program which) {
  const bool is_on_ranks = which == Program::kPodmMpi;
  CLI::App& app = add_command(program, "mesh",
                              is_on_ranks ? "mesh a label image on all ranks that mpirun or srun has started"
                                          : "mesh a label image into tetrahedra with guarantees");
  add_image_argument(app, command.image);
  add_declared_options(app, command, is_on_ranks ? kOnRanks : kInPodm);
  if (is_on_ranks) end_help(app, refused_on_ranks(command));
}

void add_planned_options(CLI::App& app, MeshCommand& command, CLI::Option* plan) {
  add_declared_options(app, command, kInPlan);
  for (const OptionGroup group : {OptionGroup::kSize, OptionGroup::kSurfaces, OptionGroup::kDihedral,
                                  OptionGroup::kAlgorithm, OptionGroup::kRun})
    need_in_group(app, title_of(group), plan);
}

void add_serve_command(CLI::App& program, ServeCommand& command) {
  CLI::App& app = add_command(program, "serve", "mesh an image in a browser, on this machine alone");
  add_declared_options(app, command, kInPodm, "Options");
  end_help(app,
           "The printed address holds a secret, without which the server refuses all requests. Ctrl-C ends\n"
           "the server and removes all images and meshes of the page.");
}

void add_convert_command(CLI::App& program, ConvertCommand& command) {
  CLI::App& app = add_command(program, "convert", "convert a mesh file of any program to another format");
  require(add_one(app, "IN", "", "mesh file that podm-verify reads", into(command.input_path)));
  require(add_one(app, "OUT", "",
                  "mesh file, with an extension that podm mesh -o accepts; or .stl or .ply, for the\n"
                  "closed surface of each label",
                  into(command.output_path)));
  add_mesh_file_options(app, command.mesh_file);
  end_help(app,
           "Labels keep their names. Facets are those between labels. Vertices, cells and facets have the\n"
           "order in which podm mesh writes them.");
}

}  // namespace podm::cli
