#include "distributed/report_of_ranks.h"

#include <algorithm>

#include "algorithms/report_on_workers.h"
#include "distributed/messages.h"

namespace podm {

namespace {

constexpr std::vector<std::uint64_t> HopsByKind::*kHopKinds[] = {
    &HopsByKind::mesh_reads, &HopsByKind::mesh_writes, &HopsByKind::image_reads,
    &HopsByKind::transform_reads};

template <class T>
void append_one(Bytes& message, const T& value) {
  append(message, std::span<const T>(&value, 1));
}
template <class T>
T read_one(MessageReader& reader) {
  return reader.read<T>().at(0);
}

void append_counters(Bytes& message, const Counters& counters) {
  append_one(message, counters.insertions_by_rule);
  std::vector<std::uint64_t> counts;
  for (const Count& count : kCounts) counts.push_back(counters.*count.member);
  append(message, counts);
  append_one(message, counters.overhead);
  for (const auto kind : kHopKinds) append(message, counters.hops.*kind);
}

Counters read_counters(MessageReader& reader) {
  Counters counters;
  counters.insertions_by_rule = read_one<decltype(counters.insertions_by_rule)>(reader);
  const auto counts = reader.read<std::uint64_t>();
  for (std::size_t i = 0; i < kCounts.size(); ++i) counters.*kCounts[i].member = counts.at(i);
  counters.overhead = read_one<Overhead>(reader);
  for (const auto kind : kHopKinds) counters.hops.*kind = reader.read<std::uint64_t>();
  return counters;
}

// A worker's place; -1 for no processor.
struct SentPlace {
  int node, socket, processor, bound_to;
};

void append_worker(Bytes& message, const WorkerReport& worker) {
  append_one(message, SentPlace{worker.node, worker.socket, worker.processor.value_or(-1),
                                worker.bound_to.value_or(-1)});
  append_counters(message, worker.counters);
}

WorkerReport read_worker(MessageReader& reader) {
  const auto place = read_one<SentPlace>(reader);
  const auto number = [](int sent) { return sent < 0 ? std::nullopt : std::optional(sent); };
  return {.node = place.node,
          .socket = place.socket,
          .processor = number(place.processor),
          .bound_to = number(place.bound_to),
          .counters = read_counters(reader)};
}

// Returns the values in the order of their keys, which are names or label values.
template <class Key, class Value>
std::vector<Value> values_of(const std::map<Key, Value>& map) {
  std::vector<Value> values;
  for (const auto& [key, value] : map) values.push_back(value);
  return values;
}

// Returns the message of a rank. All ranks have the same labels (those of the image) and the same phases
// (those of the run).
Bytes message_of(const MeshingReport& own, const PartOfRank& part) {
  Bytes message;
  append_one(message, std::array{part.cells, part.boundary_facets, part.store_cells, part.seeds,
                                 part.image_bytes_read});
  append(message, values_of(part.phases_s));
  append(message, values_of(part.spent));
  append(message, part.rounds);
  append(message, part.perturbing_rounds);
  append_one(message, part.last_update);
  append_one(message, own.perturbation.value_or(PerturbationReport()));
  append_one(message, own.stop_reason);
  append_one(message, own.guarantees);
  append_one(message, own.quality);
  append(message, values_of(own.cells_of_label));
  append(message, values_of(own.volume_of_label_mm3));
  append_one(message, static_cast<std::uint64_t>(own.workers.size()));
  for (const WorkerReport& worker : own.workers) append_worker(message, worker);
  return message;
}

// Merges extremes. The extremes of an empty mesh are such that any other value replaces them, except the
// shortest edge, which is 0.
void merge(const Quality& more, Quality& quality) {
  const auto most = [&](double Quality::*member) {
    quality.*member = std::max(quality.*member, more.*member);
  };
  const auto least = [&](double Quality::*member) {
    quality.*member = std::min(quality.*member, more.*member);
  };
  for (const auto member : {&Quality::max_radius_edge, &Quality::max_facet_angle_deg,
                            &Quality::max_dihedral_deg, &Quality::max_radius_mm})
    most(member);
  for (const auto member : {&Quality::min_facet_angle_deg, &Quality::min_dihedral_deg}) least(member);
  if (more.shortest_edge_mm > 0 && quality.shortest_edge_mm > 0) {
    least(&Quality::shortest_edge_mm);
  } else {
    most(&Quality::shortest_edge_mm);
  }
}

void add(const Guarantees& more, Guarantees& sum) {
  for (const auto member : {&Guarantees::radius_edge, &Guarantees::facet_angle, &Guarantees::radius,
                            &Guarantees::facet_vertices, &Guarantees::orientation})
    sum.*member += more.*member;
}

void add(const PerturbationReport& more, PerturbationReport& sum) {
  for (const auto cells : {&PerturbationReport::before, &PerturbationReport::after}) {
    (sum.*cells).with_free_vertex += (more.*cells).with_free_vertex;
    (sum.*cells).without += (more.*cells).without;
  }
  for (std::size_t why = 0; why < sum.unmoved.size(); ++why) sum.unmoved[why] += more.unmoved[why];
  sum.not_reached += more.not_reached;
}

template <class Key, class Value>
void add(const std::vector<Value>& more, std::map<Key, Value>& sums) {
  if (more.size() != sums.size()) throw InternalError("ranks report different labels or phases");
  std::size_t next = 0;
  for (auto& [key, sum] : sums) sum += more[next++];
}

template <class Key, class Value>
void clear(std::map<Key, Value>& sums) {
  for (auto& [key, sum] : sums) sum = {};
}

// Returns an empty report, to which the reports of all ranks are added.
MeshingReport none_like(MeshingReport own) {
  own.stop_reason = StopReason::kComplete;
  own.guarantees = {};
  own.counters = {};
  own.workers.clear();
  own.store_cells = 0;
  if (auto& sum = own.perturbation)
    sum = PerturbationReport{sum->min_dihedral_deg, sum->max_dihedral_deg, {}, {}, {}, 0};
  clear(own.cells_of_label);
  clear(own.volume_of_label_mm3);
  clear(own.phases_s);
  return own;
}

// Adds the message of a rank. `like` is a part with the phases that all ranks have.
PartOfRank add_part_of_rank(const Bytes& message, const PartOfRank& like, MeshingReport& report,
                            bool is_first) {
  MessageReader reader(message);
  const auto numbers = read_one<std::array<std::uint64_t, 5>>(reader);
  PartOfRank part{.cells = numbers[0],
                  .boundary_facets = numbers[1],
                  .store_cells = numbers[2],
                  .phases_s = like.phases_s,
                  .spent = like.spent,
                  .rounds = {},
                  .perturbing_rounds = {},
                  .seeds = numbers[3],
                  .last_update = {},
                  .image_bytes_read = numbers[4]};
  clear(part.phases_s);
  add(reader.read<double>(), part.phases_s);
  clear(part.spent);
  add(reader.read<PhaseSeconds>(), part.spent);
  part.rounds = reader.read<RoundReport>();
  part.perturbing_rounds = reader.read<RoundReport>();
  part.last_update = read_one<Update>(reader);
  report.store_cells += part.store_cells;
  const auto perturbation = read_one<PerturbationReport>(reader);
  if (report.perturbation) add(perturbation, *report.perturbation);
  report.stop_reason = std::max(report.stop_reason, read_one<StopReason>(reader));
  add(read_one<Guarantees>(reader), report.guarantees);
  const auto quality = read_one<Quality>(reader);
  if (is_first) report.quality = quality;
  merge(quality, report.quality);
  add(reader.read<std::uint64_t>(), report.cells_of_label);
  add(reader.read<double>(), report.volume_of_label_mm3);
  const auto num_workers = read_one<std::uint64_t>(reader);
  for (std::uint64_t i = 0; i < num_workers; ++i) report.workers.push_back(read_worker(reader));
  reader.expect_end();
  return part;
}

}  // namespace

std::pair<MeshingReport, std::vector<PartOfRank>> report_of_ranks(MeshingReport own, PartOfRank part,
                                                                  Communication& ranks) {
  const std::vector<Bytes> messages = ranks.all_gather(message_of(own, part));
  MeshingReport report = none_like(std::move(own));
  std::vector<PartOfRank> parts;
  for (const Bytes& message : messages)
    parts.push_back(add_part_of_rank(message, part, report, parts.empty()));
  for (auto& [phase, seconds] : report.phases_s) {
    for (const PartOfRank& of_rank : parts) seconds += of_rank.phases_s.at(phase);
    seconds /= static_cast<double>(parts.size());
  }
  if (report.calibration) report.calibration->seconds = report.phases_s.at("calibrate");
  report.counters = sum_of(report.workers);
  return {std::move(report), std::move(parts)};
}

}  // namespace podm
