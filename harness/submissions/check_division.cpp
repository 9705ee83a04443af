#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "options/option_matrix.h"
#include "rows/codec.h"
#include "rows/row_filter.h"
#include "submissions/checks.h"

namespace podm::bench {
namespace {

// podm's search for a radius ends within 5 % of the number of cells, unless it runs out of meshes.
constexpr double kToleratedShareOfCells = 0.1;

// The options that say what every mesher has to make, on any number of threads.
constexpr std::array kBounds{"radius_mm", "delta_mm", "delta_voxels", kTargetElements};

// Images and other files may lie in other folders on another machine.
bool same_image(const std::string& one, const std::string& other) {
  return is_phantom(one) ? one == other : in_name(one) == in_name(other);
}

bool same_value(const std::string& key, const Json& one, const Json& other) {
  return one == other ||
         (key == "topology" && one.is_string() && other.is_string() && in_name(one) == in_name(other));
}

// Checks of a mesh do not change it.
Json without_checks(Json options) {
  for (const char* key : {kMesher, kReplay, kFidelity, kLineDistances, kSolve}) options.erase(key);
  return options;
}

bool asks_the_same(const Json& asked, const Json& options) {
  return asked.size() == options.size() && std::ranges::all_of(asked.items(), [&](const auto& item) {
           return options.contains(item.key()) && same_value(item.key(), item.value(), options[item.key()]);
         });
}

bool has_bounds_of(const Json& asked, const Json& options) {
  return std::ranges::all_of(
      kBounds, [&](const char* key) { return asked.value(key, Json()) == options.value(key, Json()); });
}

bool is_of(const Row& row, const Trial& trial) {
  if (trial.image.empty() ? !row.input.name.empty() : !same_image(trial.image, row.input.name)) return false;
  return row.programs.peer ? has_bounds_of(asked_of(row), trial.options)
                           : asks_the_same(without_checks(asked_of(row)), without_checks(trial.options));
}

// A radius far from the one that its number of cells needs would make another task.
std::string fault_of_radius(const Row& row) {
  if (!row.resolved) return "";
  const ResolvedRadius& found = *row.resolved;
  const double share = static_cast<double>(found.cells) / static_cast<double>(found.target_elements);
  if (asked_of(row).value(kTargetElements, Json()) == found.target_elements &&
      std::abs(share - 1) <= kToleratedShareOfCells)
    return "";
  return fmt::format("its radius gave {} cells, not {}", found.cells, found.target_elements);
}

}  // namespace

const Trial* trial_of(const Row& row, const std::vector<Experiment>& experiments) {
  for (const Experiment& experiment : experiments)
    for (const Trial& trial : experiment.trials)
      if (is_of(row, trial)) return &trial;
  return nullptr;
}

void check_division(const Submission& submission, const ExperimentsOn& experiments, Faults& faults) {
  if (submission.manifest.submitter.empty()) faults.push_back({"division", "no submitter is named"});
  if (submission.manifest.division == Division::kOpen) {
    if (submission.manifest.declaration.empty())
      faults.push_back({"division", "an open submission declares how its results were made"});
    return;
  }
  for (const auto& [row, line, logs] : submission.rows) {
    const auto add = [&faults, name = name_of(row)](const std::string& fault) {
      if (!fault.empty()) faults.push_back({"division", fmt::format("{}: {}", name, fault)});
    };
    if (trial_of(row, experiments(row.environment.usable_processors)) == nullptr)
      add(row.programs.peer ? "no trial of the experiments has its input and bounds"
                            : "no trial of the experiments has its input and options");
    add(fault_of_radius(row));
  }
}

}  // namespace podm::bench
