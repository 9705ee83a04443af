#include "gate/gate_budget.h"

#include <fmt/format.h>

#include <fstream>

#include "errors.h"
#include "machine/environment.h"
#include "rows/codec.h"

namespace podm::bench {
namespace {

constexpr int kBudgetSchema = 1;

Budgets budgets_of(const Json& json) {
  if (json.at("schema") != kBudgetSchema) throw InputError(fmt::format("is not of schema {}", kBudgetSchema));
  Budgets budgets{.build = json.at("build"),
                  .instructions_tolerance = json.at("instructions_tolerance"),
                  .budgets = {},
                  .timed = from_json<GateTrial>(json.at("timed"), "timed")};
  for (const Json& member : json.at("budgets"))
    budgets.budgets.push_back({from_json<GateTrial>(member), from_json<Work>(member.at("work"), "work"),
                               member.at("instructions")});
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
               {"timed", to_json(budgets.timed)},
               {"budgets", Json::array()}};
  for (const Budget& budget : budgets.budgets) {
    Json member = to_json(budget.trial);
    member["instructions"] = budget.instructions;
    member["work"] = to_json(budget.work);
    json["budgets"].push_back(member);
  }
  std::ofstream file(path);
  file << json.dump(2) << "\n";
  if (!file.flush()) throw InputError(fmt::format("cannot write {}", path));
}

std::string this_build() {
  const EnvironmentRecord build = environment_of_run({});
  return fmt::format("{} {} {}", build.compiler, build.compiler_flags, build.build_type);
}

Work work_of(const MeshRecord& record) {
  Work work{record.counters.value_or(WorkRecord{}), record.cells, record.vertices, record.mesh_sha256};
  work.as_written.reset();  // the budgets hold the fields alone
  return work;
}

std::vector<std::string> differences(const Work& committed, const Work& measured) {
  const Json before = to_json(committed).flatten(), now = to_json(measured).flatten();
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
