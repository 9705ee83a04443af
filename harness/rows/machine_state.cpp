#include "rows/machine_state.h"

#include <fmt/format.h>

#include <map>

#include "rows/row_filter.h"

namespace podm::bench {
namespace {

std::string in_words(const Count& count) {
  const auto* const number = std::get_if<std::uint64_t>(&count);
  return number != nullptr ? std::to_string(*number) : "unknown";
}

// "48 KiB", "2 MiB".
std::string bytes_in_words(std::uint64_t bytes) {
  constexpr std::uint64_t kKib = 1024, kMib = kKib * kKib;
  return bytes % kMib == 0 ? fmt::format("{} MiB", bytes / kMib) : fmt::format("{} KiB", bytes / kKib);
}

std::string caches_in_words(const IdentityRecord& identity) {
  const auto* const caches = std::get_if<ByName<std::uint64_t>>(&identity.cache_bytes);
  if (caches == nullptr || caches->empty()) return "caches unknown";
  std::vector<std::string> parts;
  for (const auto& [level, bytes] : *caches)
    parts.push_back(fmt::format("{} {}", level, bytes_in_words(bytes)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string identity_in_words(const IdentityRecord& identity) {
  return fmt::format("{} family {} model {} stepping {}; {}; {} GiB; {}", identity.vendor,
                     in_words(identity.family), in_words(identity.model), in_words(identity.stepping),
                     caches_in_words(identity), in_words(identity.memory_gib), identity.kernel);
}

// The topology distinguishes only rows that have no identity.
std::string topology_of(const Row& row) {
  return row.environment.identity ? "" : row.environment.topology_sha256;
}

}  // namespace

bool same_machine(const Row& a, const Row& b) {
  const MachineRecord &of_a = a.environment, &of_b = b.environment;
  return of_a == of_b && topology_of(a) == topology_of(b);
}

std::string machine_name(const Row& row) {
  const EnvironmentRecord& machine = row.environment;
  if (machine.cpu.empty()) return "a machine without a name";
  const std::string identity = machine.identity ? identity_in_words(*machine.identity)
                               : machine.topology_sha256.empty()
                                   ? "no identity"
                                   : fmt::format("no identity, topology {:.8}", machine.topology_sha256);
  return fmt::format("{} ({}; {} packages, {} NUMA nodes, {} cores, {} of {} processors)", machine.cpu,
                     identity, in_words(machine.packages), in_words(machine.numa_nodes),
                     in_words(machine.cores), machine.usable_processors, in_words(machine.processors));
}

std::string model_of(const Row& row) {
  if (!is_simulated(row)) return "";
  const std::string nodes = fmt::format("{} NUMA nodes", in_words(row.environment.numa_nodes));
  if (!row.mesh || !row.mesh->virtual_time || !row.mesh->virtual_time->as_written) return nodes;
  const Json& record = *row.mesh->virtual_time->as_written;
  const Json::json_pointer place("/machine/sha256");
  return record.contains(place) && record[place].is_string() ? record[place].get<std::string>() : nodes;
}

double busy_elsewhere(const Row& row) {
  if (!row.environment.busy_elsewhere) return 0;
  const auto* const busy = std::get_if<double>(&*row.environment.busy_elsewhere);
  return busy != nullptr ? *busy : 0;
}

bool is_disturbed(const Row& row) {
  return !is_simulated(row) && busy_elsewhere(row) > kToleratedLoad * row.environment.usable_processors;
}

bool probe_moved(const Row& row) { return row.probe_moved.value_or(false); }

MachineState machine_state(const std::vector<Row>& rows) {
  MachineState state;
  double busy = 0;
  for (const Row& row : rows) {
    if (is_simulated(row) || row.status == Status::kSkipped) continue;
    ++state.measured;
    state.moved += probe_moved(row);
    if (!is_disturbed(row)) continue;
    ++state.disturbed;
    busy += busy_elsewhere(row);
    state.processors = row.environment.usable_processors;
  }
  if (state.disturbed > 0) state.busy_elsewhere = busy / state.disturbed;
  return state;
}

std::vector<std::string> MachineState::remarks() const {
  std::vector<std::string> sentences;
  if (disturbed > 0)
    sentences.push_back(fmt::format(
        "Other work kept {:.1f} of {} processors busy during {} of {} runs: measured claims are not "
        "resolved.",
        busy_elsewhere, processors, disturbed, measured));
  if (moved > 0)
    sentences.push_back(
        fmt::format("The machine's speed moved during the rounds of {} of {} runs: their times do not count.",
                    moved, measured));
  return sentences;
}

std::string describe_left_out(const std::vector<Row>& rows_of_other_machines) {
  if (rows_of_other_machines.empty()) return "";
  std::map<std::string, int> numbers;
  for (const Row& row : rows_of_other_machines) ++numbers[machine_name(row)];
  std::vector<std::string> parts;
  for (const auto& [name, number] : numbers) parts.push_back(fmt::format("{} of {}", number, name));
  return fmt::format("Rows of other machines than the newest row's are left out: {}.",
                     fmt::join(parts, ", "));
}

}  // namespace podm::bench
