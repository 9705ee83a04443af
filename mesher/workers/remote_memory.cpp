#include "workers/remote_memory.h"

#include <algorithm>
#include <utility>

namespace podm {

RemoteMemory::RemoteMemory(const MachineModel& machine, std::vector<NodeIndex> nodes)
    : machine_(machine),
      nodes_(std::move(nodes)),
      charged_(nodes_.size() * static_cast<std::size_t>(machine.topology.num_nodes())),
      asked_(machine.stations.size()),
      queues_(machine.stations.size()) {}

RemoteMemory::Delay RemoteMemory::delay(WorkerId worker, const AccessTally& accesses, double now_s) {
  Delay delay;
  const NodeIndex from = nodes_[worker];
  for (NodeIndex to = 0; to < machine_.topology.num_nodes(); ++to) {
    if (to == from) continue;
    const double num_accesses = accesses_to(worker, to, accesses);
    if (num_accesses == 0) continue;
    delay.latency_s += num_accesses * machine_.num_links(from, to) * machine_.hop_latency_s;
    for (const int station : machine_.route(from, to))
      asked_[static_cast<std::size_t>(station)] += num_accesses;
  }
  for (std::size_t station = 0; station < asked_.size(); ++station)
    delay.network_s += waits_at(station, std::exchange(asked_[station], 0), now_s);
  return delay;
}

double RemoteMemory::accesses_to(WorkerId worker, NodeIndex node, const AccessTally& accesses) {
  const auto count = [&](AccessKind kind) { return static_cast<double>(accesses.by_node(kind)[node]); };
  const double so_far = machine_.miss_share * (count(AccessKind::kMeshRead) + count(AccessKind::kMeshWrite)) +
                        count(AccessKind::kFirstRead);
  const auto num_nodes = static_cast<std::size_t>(machine_.topology.num_nodes());
  return so_far - std::exchange(charged_[worker * num_nodes + node], so_far);
}

void RemoteMemory::Queue::drop_served(double now_s) {
  while (!batches.empty() && batches.front().served_at_s <= now_s) {
    num_accesses -= batches.front().num_accesses;
    batches.pop_front();
  }
}

double RemoteMemory::waits_at(std::size_t station, double num_accesses, double now_s) {
  const double service_s = machine_.stations[station].service_s;
  if (service_s == 0 || num_accesses == 0) return 0;
  Queue& queue = queues_[station];
  queue.drop_served(now_s);
  const double begins_s = queue.batches.empty() ? now_s : queue.batches.back().served_at_s;
  const double each_s = service_s * (1 + machine_.retries * queue.num_accesses);
  queue.batches.push_back({begins_s + num_accesses * each_s, num_accesses});
  queue.num_accesses += num_accesses;
  return num_accesses * (begins_s - now_s);
}

}  // namespace podm
