#include "cli/reports/ranks_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/options/options_for_image.h"
#include "cli/processes/process_memory.h"
#include "cli/reports/json_text.h"
#include "distributed/messages.h"
#include "image/image_by_bricks.h"
#include "podm/mesh_io.h"
#include "runtime/virtual_threads.h"

namespace podm {

PODM_TO_JSON(PhaseSeconds, computing_s, waiting_s, network_s)

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

// The cost of a rank and its process. A process with virtual clocks has other ranks, too.
struct Spent {
  std::uint64_t threads, peak_rss_bytes;
  bool is_virtual, is_complete;  // complete: virtual time includes all threads
  RankReport report;
};

Spent spent_by(const Communication& ranks, int threads) {
  const bool is_complete = threads == 1 || VirtualThreads::current() != nullptr;
  return {.threads = static_cast<std::uint64_t>(threads),
          .peak_rss_bytes = peak_resident_bytes(),
          .is_virtual = ranks.is_virtual(),
          .is_complete = is_complete,
          .report = ranks.report()};
}

// The rounds of one task.
using Rounds = std::vector<RoundReport> PartOfRank::*;

// Returns one round on all ranks: sums, and the seconds of the slowest rank.
RoundReport on_all(const std::vector<PartOfRank>& parts, Rounds rounds, std::size_t round) {
  RoundReport all;
  for (const PartOfRank& part : parts) {
    const RoundReport& one = (part.*rounds)[round];
    all.entries += one.entries;
    all.insertions += one.insertions;
    all.in_leaves += one.in_leaves;
    all.deferred = one.deferred;
    all.cubes += one.cubes;
    all.update += one.update;
    all.update_s = std::max(all.update_s, one.update_s);
    all.refine_s = std::max(all.refine_s, one.refine_s);
  }
  return all;
}

// Returns the largest number of cells of a rank over the mean.
double imbalance(const std::vector<PartOfRank>& parts) {
  std::uint64_t most = 0, sum = 0;
  for (const PartOfRank& part : parts) {
    most = std::max(most, part.cells);
    sum += part.cells;
  }
  return sum == 0 ? 1 : static_cast<double>(most * parts.size()) / static_cast<double>(sum);
}

Json update_of(const Update& update) {
  return {{"cubes", update.cubes},
          {"vertices_told", update.vertices_received},
          {"inserted", update.inserted},
          {"removed", update.removed}};
}

// Returns the number of ranks that inserted vertices. If it is 1 in a late round, the deferred cells were one
// connected part.
std::size_t ranks_refining(const std::vector<PartOfRank>& parts, Rounds rounds, std::size_t round) {
  return static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(), [&](const PartOfRank& part) {
    return (part.*rounds)[round].insertions > 0;
  }));
}

Json rounds_of(const std::vector<PartOfRank>& parts, Rounds rounds) {
  Json all = Json::array();
  for (std::size_t i = 0; i < (parts[0].*rounds).size(); ++i) {
    const RoundReport round = on_all(parts, rounds, i);
    all.push_back({{"ranks_refining", ranks_refining(parts, rounds, i)},
                   {"entries", round.entries},
                   {"insertions", round.insertions},
                   {"in_leaves", round.in_leaves},
                   {"deferred", round.deferred},
                   {"cubes", round.cubes},
                   {"update", update_of(round.update)},
                   {"update_s", round.update_s},
                   {"refine_s", round.refine_s}});
  }
  return all;
}

Json memory_of(const Spent& spent) { return spent.is_virtual ? Json(nullptr) : Json(spent.peak_rss_bytes); }

bool has_virtual_time(const Spent& spent) { return spent.is_virtual && spent.is_complete; }

Json virtual_time_of(const Spent& spent) {
  if (!has_virtual_time(spent)) return nullptr;
  const RankReport& report = spent.report;
  return {{"computing_s", report.computing_s},
          {"waiting_s", report.waiting_s},
          {"network_s", report.network_s},
          {"messages", report.messages_sent},
          {"bytes", report.bytes_sent}};
}

Json network_of(const MeshCommand& command) {
  if (std::isinf(command.network.gigabytes_per_s)) return nullptr;
  return {{"latency_us", command.network.latency_us}, {"gigabytes_per_s", command.network.gigabytes_per_s}};
}

Json ranks_of(const std::vector<PartOfRank>& parts, const std::vector<Spent>& spent,
              const RanksOfMachine& machines, const MeshRun& run) {
  Json by_rank = Json::array();
  Update last;
  for (std::size_t rank = 0; rank < parts.size(); ++rank) {
    const PartOfRank& part = parts[rank];
    by_rank.push_back({{"host", machines.host(rank)},
                       {"threads", spent[rank].threads},
                       {"cells", part.cells},
                       {"boundary_facets", part.boundary_facets},
                       {"store_cells", part.store_cells},
                       {"seed_vertices", part.seeds},
                       {"image_bytes_read", part.image_bytes_read},
                       {"peak_rss_bytes", memory_of(spent[rank])},
                       {"phases_s", part.phases_s},
                       {"spent", part.spent},
                       {"virtual", virtual_time_of(spent[rank])}});
    last += part.last_update;
  }
  return {{"number", parts.size()},
          {"machines", machines.num_machines()},
          {"carrier", run.command.ranks_in_process > 0 ? "in-process" : "mpi"},
          {"network", network_of(run.command)},
          {"image", by_bricks(run.image) != nullptr ? "by bricks" : "whole"},
          {"initial_ratio", run.options.leaves.initial_ratio},
          {"imbalance", imbalance(parts)},
          {"rounds", rounds_of(parts, &PartOfRank::rounds)},
          {"perturbing_rounds", rounds_of(parts, &PartOfRank::perturbing_rounds)},
          {"last_update", update_of(last)},
          {"by_rank", by_rank}};
}

std::string memory_text(const std::vector<Spent>& spent) {
  const auto [least, most] =
      std::minmax_element(spent.begin(), spent.end(),
                          [](const Spent& a, const Spent& b) { return a.peak_rss_bytes < b.peak_rss_bytes; });
  const auto gib = [](std::uint64_t bytes) { return static_cast<double>(bytes) / kBytesPerGib; };
  return fmt::format("memory per rank {:.3f} to {:.3f} GiB", gib(least->peak_rss_bytes),
                     gib(most->peak_rss_bytes));
}

std::string virtual_time_text(const std::vector<Spent>& spent) {
  if (!has_virtual_time(spent[0]))
    return "no virtual time: the clock of a rank does not include its other threads (see --executor)";
  double computing_s = 0, waiting_s = 0;
  std::uint64_t bytes = 0;
  for (const Spent& one : spent) {
    computing_s = std::max(computing_s, one.report.computing_s);
    waiting_s = std::max(waiting_s, one.report.waiting_s);
    bytes += one.report.bytes_sent;
  }
  return fmt::format(
      "virtual time per rank at most {:.2f} s computing, {:.2f} s waiting, {:.4f} s network; {} bytes sent",
      computing_s, waiting_s, spent[0].report.network_s, bytes);
}

std::string text_of(const std::vector<PartOfRank>& parts, const std::vector<Spent>& spent,
                    const RanksOfMachine& machines, Algorithm algorithm) {
  const bool is_virtual = spent[0].is_virtual;
  const std::string where = is_virtual ? "in this process"
                                       : fmt::format("on {} machine{}", machines.num_machines(),
                                                     machines.num_machines() > 1 ? "s" : "");
  std::string text = fmt::format(
      "ranks      {} {}, by {}; the rank with most cells has {:.3g} times the mean;\n           {}\n",
      parts.size(), where, to_string(algorithm), imbalance(parts),
      is_virtual ? virtual_time_text(spent) : memory_text(spent));
  if (parts[0].rounds.empty()) return text;
  text += fmt::format("{:>10} {:>11} {:>11} {:>11} {:>17} {:>17} {:>9}\n", "round", "entries", "insertions",
                      "deferred", "vertices received", "seconds: exchange", "refine");
  for (std::size_t i = 0; i < parts[0].rounds.size(); ++i) {
    const RoundReport round = on_all(parts, &PartOfRank::rounds, i);
    text += fmt::format("{:>10} {:>11} {:>11} {:>11} {:>14} {:>17.2f} {:>9.2f}\n", i, round.entries,
                        round.insertions, round.deferred, round.update.vertices_received, round.update_s,
                        round.refine_s);
  }
  return text;
}

}  // namespace

void gather_from_ranks(const MeshingOnRanks& result, int threads, const RanksOfMachine& machines,
                       Communication& ranks, MeshRun& run) {
  const Spent own = spent_by(ranks, threads);
  Bytes message;
  append(message, std::span<const Spent>(&own, 1));
  append(message, numbers_of(result.piece.mesh).facet_pairs);
  std::vector<Spent> spent;
  std::vector<FacetCount> pairs;
  for (const Bytes& received : ranks.all_gather(std::move(message))) {
    MessageReader reader(received);
    spent.push_back(reader.read<Spent>().at(0));
    run.peak_rss_bytes = std::max(run.peak_rss_bytes, spent.back().peak_rss_bytes);
    const auto more = reader.read<FacetCount>();
    pairs.insert(pairs.end(), more.begin(), more.end());
  }
  run.mesh = {.cells = result.piece.total_cells,
              .vertices = result.piece.total_vertices,
              .boundary_facets = result.piece.total_facets,
              .facet_pairs = sums_of(pairs)};
  Json record = ranks_of(result.parts, spent, machines, run);
  if (const auto& from = result.resumed) {
    record["resumed"] = {{"rounds", from->rounds}, {"ranks", from->ranks}};
  } else {
    record["resumed"] = nullptr;
  }
  record["mesh_hash"] = mesh_hash_text(result.mesh_hash);
  run.ranks = std::make_shared<const Json>(std::move(record));
  run.ranks_text = text_of(result.parts, spent, machines, result.report.algorithm) +
                   fmt::format("hash       {}\n", mesh_hash_text(result.mesh_hash));
  if (const auto& from = result.resumed)
    run.ranks_text +=
        fmt::format("resumed    a checkpoint of {} ranks, after {} rounds\n", from->ranks, from->rounds);
}

}  // namespace cli
}  // namespace podm
