#include "cli/processes/ranks_of_machine.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "distributed/messages.h"
#include "runtime/placement.h"

namespace podm::cli {
namespace {

// Returns an id that is the same in all containers of a machine, independent of their host names.
std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  if (!(file >> id)) throw InternalError("/proc/sys/kernel/random/boot_id cannot be read");
  return id;
}

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) throw InternalError("gethostname failed");
  return name.data();
}

}  // namespace

RanksOfMachine::RanksOfMachine(Communication& ranks)
    : ranks_(ranks), own_(static_cast<std::size_t>(ranks.rank())) {
  Bytes message;
  append(message, std::span<const char>(boot_id()));
  append(message, std::span<const char>(host_name()));
  append(message, processors_of_this_thread());
  std::vector<std::string> ids;
  for (const Bytes& received : ranks.all_gather(std::move(message))) {
    MessageReader reader(received);
    const auto id = reader.read<char>(), host = reader.read<char>();
    Place place{{id.begin(), id.end()}, {host.begin(), host.end()}, reader.read<int>()};
    const auto known = std::find(ids.begin(), ids.end(), place.boot_id);
    place.machine = static_cast<std::size_t>(known - ids.begin());
    if (known == ids.end()) {
      ids.push_back(place.boot_id);
      machines_.emplace_back();
    }
    Machine& machine = machines_[place.machine];
    ++machine.num_ranks;
    std::vector<int> all;
    std::set_union(machine.processors.begin(), machine.processors.end(), place.processors.begin(),
                   place.processors.end(), std::back_inserter(all));
    machine.processors = std::move(all);
    places_.push_back(std::move(place));
  }
}

int RanksOfMachine::share_of_processors() const {
  const auto all = static_cast<int>(here().processors.size());
  const auto own = static_cast<int>(places_[own_].processors.size());
  return std::max(1, std::min(own, all / here().num_ranks));
}

std::vector<std::string> RanksOfMachine::warnings(int threads) const {
  std::vector<std::uint64_t> threads_of_machine(machines_.size());
  threads_of_machine[places_[own_].machine] = static_cast<std::uint64_t>(threads);
  ranks_.sum(threads_of_machine);
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < machines_.size(); ++i) {
    const Machine& machine = machines_[i];
    if (threads_of_machine[i] <= machine.processors.size()) continue;
    lines.push_back(fmt::format(
        "{}: {} ranks request {} threads but may use {} processors; use fewer threads, or unbind the ranks "
        "(mpirun --bind-to none)",
        host_of_machine(i), machine.num_ranks, threads_of_machine[i], machine.processors.size()));
  }
  const auto shared = std::find_if(machines_.begin(), machines_.end(),
                                   [](const Machine& machine) { return machine.num_ranks > 1; });
  if (shared != machines_.end())
    lines.push_back(fmt::format(
        "{}: {} ranks; one rank per machine with a thread per core learns fewer vertices and holds the image "
        "once (Open MPI: mpirun --map-by ppr:1:node --bind-to none)",
        host_of_machine(static_cast<std::size_t>(shared - machines_.begin())), shared->num_ranks));
  return lines;
}

const std::string& RanksOfMachine::host_of_machine(std::size_t machine) const {
  return std::find_if(places_.begin(), places_.end(), [&](const Place& p) { return p.machine == machine; })
      ->host;
}

}  // namespace podm::cli
