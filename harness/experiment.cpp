#include "experiment.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace podm::bench {
namespace {

constexpr double kDefaultTimeoutS = 600;
constexpr std::int64_t kMaxThreads = 1024;
constexpr std::int64_t kMaxElements = std::numeric_limits<std::uint32_t>::max();

// A table of the file, asked key by key; done() refuses the keys that nobody asked for.
class Section {
 public:
  Section(const std::string& path, const toml::table& table, std::string name)
      : path_(path), table_(table), name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::source_region& place, const std::string& fault) const {
    throw InputError(fmt::format("{}:{}:{}: {}", path_, place.begin.line, place.begin.column, fault));
  }
  const toml::source_region& place() const { return table_.source(); }
  const toml::source_region& place(std::string_view key) const { return table_.find(key)->second.source(); }
  bool has(std::string_view key) const { return table_.contains(key); }

  std::string text(std::string_view key) {
    const toml::node& node = required(key);
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) fail(node.source(), fmt::format("{} must be a non-empty string", key));
    return *value;
  }
  bool flag(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return false;
    const auto value = node->value_exact<bool>();
    if (!value) fail(node->source(), fmt::format("{} must be true or false", key));
    return *value;
  }
  double positive(std::string_view key, double otherwise) {
    const toml::node* node = find(key);
    if (node == nullptr) return otherwise;
    const auto value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value || !(*value > 0) || !(*value < std::numeric_limits<double>::infinity()))
      fail(node->source(), fmt::format("{} must be a positive number", key));
    return *value;
  }
  std::int64_t count(std::string_view key, std::int64_t otherwise, std::int64_t most) {
    const toml::node* node = find(key);
    if (node == nullptr) return otherwise;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > most)
      fail(node->source(), fmt::format("{} must be an integer from 1 to {}", key, most));
    return *value;
  }
  // The tables [key.NAME], by name.
  std::vector<std::pair<std::string, Section>> tables(std::string_view key) {
    const toml::node& node = required(key);
    if (!node.is_table()) fail(node.source(), fmt::format("write each of {0} as a table, [{0}.NAME]", key));
    std::vector<std::pair<std::string, Section>> sections;
    for (const auto& [name, member] : *node.as_table())
      sections.push_back(member_of(key, name.str(), member));
    return sections;
  }
  // The tables [[key]], in the order of the file.
  std::vector<Section> table_array(std::string_view key) {
    const toml::node& node = required(key);
    if (!node.is_array_of_tables())
      fail(node.source(), fmt::format("write each of {0} as a table, [[{0}]]", key));
    std::vector<Section> sections;
    for (const toml::node& member : *node.as_array())
      sections.emplace_back(path_, *member.as_table(), "[[" + std::string(key) + "]]");
    return sections;
  }
  void done() const {
    for (const auto& [key, node] : table_)
      if (!asked_.contains(key.str()))
        fail(key.source(),
             fmt::format("{} has no key '{}'; it has {}", name_, key.str(), fmt::join(asked_, ", ")));
  }

 private:
  std::pair<std::string, Section> member_of(std::string_view key, std::string_view name,
                                            const toml::node& member) const {
    const std::string title = fmt::format("[{}.{}]", key, name);
    if (!member.is_table()) fail(member.source(), fmt::format("{} must be a table", title));
    return {std::string(name), Section(path_, *member.as_table(), title)};
  }
  const toml::node* find(std::string_view key) {
    asked_.emplace(key);
    return table_.get(key);
  }
  const toml::node& required(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) fail(table_.source(), fmt::format("{} needs the key '{}'", name_, key));
    return *node;
  }

  const std::string& path_;
  const toml::table& table_;
  std::string name_;
  std::set<std::string, std::less<>> asked_;
};

struct Input {
  std::string image;
  bool if_exists = false;
};

// Relative to the folder of the experiment, so that it runs from anywhere.
std::string resolve_image(const std::string& image, const std::string& experiment_path) {
  if (image.starts_with("phantom:")) return image;
  return (std::filesystem::path(experiment_path).parent_path() / image).lexically_normal().string();
}

std::map<std::string, Input> read_inputs(Section& file, const std::string& path) {
  std::map<std::string, Input> inputs;
  for (auto& [name, section] : file.tables("inputs")) {
    inputs[name] = {resolve_image(section.text("image"), path), section.flag("if_exists")};
    section.done();
  }
  return inputs;
}

// Trial names become parts of file names.
bool is_file_name(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  return name.front() != '.' && std::all_of(name.begin(), name.end(), plain);
}

Trial read_trial(Section& section, const std::map<std::string, Input>& inputs, double timeout_s) {
  Trial trial;
  trial.name = section.text("name");
  if (!is_file_name(trial.name))
    section.fail(section.place("name"), "a trial's name may have letters, digits and . _ - only");
  const std::string input = section.text("input");
  if (!inputs.contains(input))
    section.fail(section.place("input"), fmt::format("there is no [inputs.{}]", input));
  trial.image = inputs.at(input).image;
  trial.if_exists = inputs.at(input).if_exists;
  trial.radius_mm = section.positive("radius_mm", 0);
  trial.delta_mm = section.positive("delta_mm", 0);
  trial.target_elements = static_cast<std::uint64_t>(section.count("target_elements", 0, kMaxElements));
  trial.threads = static_cast<int>(section.count("threads", 1, kMaxThreads));
  trial.timeout_s = section.positive("timeout_s", timeout_s);
  if (section.has("radius_mm") && section.has("target_elements"))
    section.fail(section.place("target_elements"), "radius_mm and target_elements exclude each other");
  section.done();
  return trial;
}

toml::table parse_file(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw InputError(path + ": no such file");
  try {
    return toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    const toml::source_position& place = error.source().begin;
    throw InputError(fmt::format("{}:{}:{}: {}", path, place.line, place.column, error.description()));
  }
}

}  // namespace

Experiment read_experiment(const std::string& path) {
  const toml::table table = parse_file(path);
  Section file(path, table, "an experiment");
  Experiment experiment;
  experiment.name = std::filesystem::path(path).stem().string();
  experiment.title = file.text("title");
  experiment.claim = file.text("claim");
  experiment.expected_minutes = file.positive("expected_minutes", 0);
  const double timeout_s = file.positive("timeout_s", kDefaultTimeoutS);
  const auto inputs = read_inputs(file, path);
  std::set<std::string> names;
  for (Section& section : file.table_array("trials")) {
    experiment.trials.push_back(read_trial(section, inputs, timeout_s));
    if (!names.insert(experiment.trials.back().name).second)
      section.fail(section.place("name"), fmt::format("a second trial '{}'", experiment.trials.back().name));
  }
  file.done();
  return experiment;
}

std::vector<std::string> experiment_files(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  if (error) throw InputError(fmt::format("cannot read {}: {}", folder, error.message()));
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool image_exists(const Trial& trial) {
  std::error_code error;
  return trial.image.starts_with("phantom:") || std::filesystem::exists(trial.image, error);
}

}  // namespace podm::bench
