#include "experiments/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "experiments/claim_names.h"
#include "options/option_matrix.h"
#include "runtime/toml_section.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kDefaultTimeoutS = 600;
constexpr std::int64_t kMaxRepeats = 10'000;

struct Input {
  std::string image;
  bool if_exists = false;
};
using Inputs = std::map<std::string, Input>;

// The path is relative to the folder of the experiment, so that the experiment runs from any folder.
std::string resolve_image(const std::string& image, const fs::path& folder) {
  return is_phantom(image) ? image : (folder / image).lexically_normal().string();
}

Inputs read_inputs(TomlSection& file, const fs::path& folder) {
  Inputs inputs;
  if (!file.has("inputs")) return inputs;  // then no trial may name one
  for (auto& [name, section] : file.tables("inputs")) {
    inputs[name] = {resolve_image(section.text("image"), folder), section.flag("if_exists")};
    section.done();
  }
  return inputs;
}

Tier read_tier(TomlSection& section, Tier otherwise) {
  const std::string text = section.text("tier", to_string(otherwise));
  try {
    return parse_tier(text);
  } catch (const InputError& error) {
    section.fail("tier", error.what());
  }
}

// Reads settings that the head of the file and each trial may set. The trial's own setting wins.
void read_run_settings(TomlSection& section, Trial& trial) {
  trial.timeout_s = section.positive("timeout_s", trial.timeout_s);
  trial.memory_limit_gib = section.positive("memory_limit_gib", trial.memory_limit_gib);
  trial.repeats = static_cast<int>(section.count("repeats", trial.repeats, 1, kMaxRepeats));
  trial.warmups = static_cast<int>(section.count("warmup", trial.warmups, 0, kMaxRepeats));
  trial.tier = read_tier(section, trial.tier);
}

// Names of trials become parts of file names.
std::string read_name(TomlSection& section) {
  const std::string name = section.text("name");
  if (name.front() == '.' || in_name(name) != name)
    section.fail("name", "a trial's name may have letters, digits and . _ - only");
  return name;
}

// Returns one empty name if the trial needs no input.
std::vector<std::string> read_input_names(TomlSection& section, const Inputs& inputs) {
  if (section.has(kMeasure)) {
    if (section.has("input")) section.fail("input", "input is an option of meshers");
    return {""};
  }
  std::vector<std::string> names;
  for (const TomlValue& input : section.values("input")) {
    names.push_back(input.text());
    if (!inputs.contains(names.back())) input.fail(fmt::format("there is no [inputs.{}]", names.back()));
  }
  if (names.empty()) section.text("input");  // throws: the key is absent
  return names;
}

// An input of the trials of one [[trials]], and its part of their names, which may be empty.
struct NamedInput {
  std::string suffix;
  Input input;
};

// Returns the inputs of the file, or the images if there are any.
std::vector<NamedInput> inputs_of_trials(TomlSection& section, const Inputs& inputs,
                                         const std::vector<std::string>& images) {
  std::vector<NamedInput> named;
  const auto add = [&named](bool in_suffix, const std::string& name, Input input) {
    named.push_back({in_suffix ? ",input=" + in_name(name) : "", std::move(input)});
  };
  const std::vector<std::string> names = read_input_names(section, inputs);
  for (const std::string& name : names) {
    if (name.empty()) return {NamedInput{}};
    if (images.empty()) add(section.is_array("input"), name, inputs.at(name));
  }
  for (const std::string& image : images) add(images.size() > 1, image, {image, false});
  return named;
}

// Keeps the number of voxels per thread constant. An image that the user gives in place of a phantom stays as
// it is.
void grow(const TomlSection& section, bool is_given, Trial& trial) {
  if (!trial.options.value(kImageGrows, false)) return;
  const auto image = grown(trial.image, trial.options["threads"].get<double>());
  if (image) trial.image = *image;
  if (!image && !is_given)
    section.fail(kImageGrows, fmt::format("{} needs a phantom and its size, phantom:NAME@SIZE, not {}",
                                          kImageGrows, trial.image));
}

// Reads the matrix of one [[trials]].
std::vector<Trial> read_trials(TomlSection& section, const Inputs& inputs, const Trial& head,
                               const MatrixContext& context, const std::vector<std::string>& images) {
  Trial common = head;
  common.name = read_name(section);
  read_run_settings(section, common);
  const std::vector<NamedInput> named_inputs = inputs_of_trials(section, inputs, images);
  const std::vector<Variant> variants = read_matrix(section, context);
  section.done();
  std::vector<Trial> trials;
  for (const auto& [suffix, input] : named_inputs)
    for (const Variant& variant : variants) {
      Trial trial = common;
      trial.name += suffix + variant.suffix;
      trial.image = input.image;
      trial.if_exists = input.if_exists;
      trial.options = variant.options;
      // The cells of a given image may be larger than its structures.
      if (!images.empty() && !trial.image.empty()) trial.options[kFidelity] = false;
      grow(section, !images.empty(), trial);
      trials.push_back(std::move(trial));
    }
  return trials;
}

std::vector<Claim> read_claims(TomlSection& file, const std::vector<Trial>& trials) {
  std::vector<ClaimedTrial> claimed;
  for (const Trial& trial : trials) claimed.push_back({stem_of(trial.name), complete_options(trial.options)});
  std::vector<Claim> claims;
  for (TomlSection& section : file.table_array("claims")) claims.push_back(read_claim(section, claimed));
  return claims;
}

std::vector<WithdrawnClaim> read_withdrawn(TomlSection& file) {
  std::vector<WithdrawnClaim> withdrawn;
  if (!file.has("withdrawn")) return withdrawn;
  for (TomlSection& section : file.table_array("withdrawn"))
    withdrawn.push_back(read_withdrawn_claim(section));
  return withdrawn;
}

}  // namespace

std::size_t Experiment::num_turns() const {
  std::size_t turns = 0;
  for (const Trial& trial : trials) turns += static_cast<std::size_t>(trial.repeats + trial.warmups);
  return turns;
}

Experiment read_experiment(const std::string& path, const std::vector<std::string>& images,
                           int processors) try {
  const TomlValue table = parse_toml(path);
  TomlSection file(table, "an experiment");
  const std::string folder = fs::path(path).parent_path().string();
  Experiment experiment;
  experiment.name = fs::path(path).stem().string();
  experiment.title = file.text("title");
  experiment.claim = file.text("claim");
  experiment.paper = file.text("paper", "");
  experiment.expected_minutes = file.positive("expected_minutes", 0);
  Trial head;
  head.timeout_s = kDefaultTimeoutS;
  read_run_settings(file, head);
  experiment.tier = head.tier;
  const Inputs inputs = read_inputs(file, folder);
  std::set<std::string> names;
  for (TomlSection& section : file.table_array("trials"))
    for (Trial& trial : read_trials(section, inputs, head, {folder, processors}, images)) {
      if (!names.insert(trial.name).second)
        section.fail("name", fmt::format("a second trial '{}'", trial.name));
      experiment.trials.push_back(std::move(trial));
    }
  experiment.claims = read_claims(file, experiment.trials);
  experiment.withdrawn = read_withdrawn(file);
  file.done();
  check_claim_names({experiment});
  return experiment;
} catch (const TomlError& fault) {
  throw InputError(fault.what());
}

std::vector<std::string> experiment_files(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  if (error) throw InputError(fmt::format("cannot read {}: {}", folder, error.message()));
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace podm::bench
