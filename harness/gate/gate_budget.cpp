#include "gate/gate_budget.h"

#include <fmt/format.h>

#include <fstream>

#include "machine/environment.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kBudgetSchema = 1;

GateTrial trial_of(const Json& json) { return {json.at("name"), json.at("image"), json.at("radius_mm")}; }

Json json_of(const GateTrial& trial) {
  return {{"name", trial.name}, {"image", trial.image}, {"radius_mm", trial.radius_mm}};
}

Budgets budgets_of(const Json& json) {
  if (json.at("schema") != kBudgetSchema) throw InputError(fmt::format("is not of schema {}", kBudgetSchema));
  Budgets budgets{.build = json.at("build"),
                  .instructions_tolerance = json.at("instructions_tolerance"),
                  .budgets = {},
                  .timed = trial_of(json.at("timed"))};
  for (const Json& member : json.at("budgets"))
    budgets.budgets.push_back({trial_of(member), member.at("work"), member.at("instructions")});
  return budgets;
}

}  // namespace

Budgets read_budgets(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("cannot read {}", path));
  try {
    return budgets_of(Json::parse(file));
  } catch (const std::exception& fault) {
    throw InputError(fmt::format("{}: {}", path, fault.what()));
  }
}

void write_budgets(const Budgets& budgets, const std::string& path) {
  Json json = {{"schema", kBudgetSchema},
               {"build", budgets.build},
               {"instructions_tolerance", budgets.instructions_tolerance},
               {"timed", json_of(budgets.timed)},
               {"budgets", Json::array()}};
  for (const Budget& budget : budgets.budgets) {
    Json member = json_of(budget.trial);
    member["instructions"] = budget.instructions;
    member["work"] = budget.work;
    json["budgets"].push_back(member);
  }
  std::ofstream file(path);
  file << json.dump(2) << "\n";
  if (!file.flush()) throw InputError(fmt::format("cannot write {}", path));
}

std::string this_build() {
  const Json build = environment_of_run();
  return fmt::format("{} {} {}", build["compiler"].get<std::string>(),
                     build["compiler_flags"].get<std::string>(), build["build_type"].get<std::string>());
}

Json work_of(const Json& record) {
  const Json counters = record.value("counters", Json::object());
  const auto counted = [&](const char* key) { return counters.value(key, Json()); };
  return {{"cells", record.value("cells", Json())},
          {"vertices", record.value("vertices", Json())},
          {"insertions", counted("insertions")},
          {"removals", counted("removals")},
          {"classified_cells", counted("classified_cells")},
          {"conflict_tests", counted("conflict_tests")},
          {"exact_decisions", counted("exact_decisions")},
          {"cells_created", counted("cells_created")},
          {"mesh_sha256", record.value("mesh_sha256", Json())}};
}

std::vector<std::string> differences(const Json& committed, const Json& measured) {
  const Json before = committed.flatten(), now = measured.flatten();
  std::vector<std::string> texts;
  const auto add = [&](const std::string& pointer) {
    texts.push_back(fmt::format("{}: {}, committed {}", pointer.substr(1), now.value(pointer, Json()).dump(),
                                before.value(pointer, Json()).dump()));
  };
  for (const auto& [pointer, value] : before.items())
    if (now.value(pointer, Json()) != value) add(pointer);
  for (const auto& [pointer, value] : now.items())
    if (!before.contains(pointer)) add(pointer);
  return texts;
}

}  // namespace podm::bench
