// The cost of remote access on a described machine: the way to the other node and back, and the time spent
// waiting where the network is busy.
//
//   The fraction `miss_share` of the counted accesses to another node's cells and vertices goes to that node;
//   caches answer the rest. Such an access takes longer than a local one by the latency of the links between.
//   The image and its transform are never written: each of their cache lines goes over the network to each
//   node once, and the node's caches keep it.
//   An access keeps each station on its way (a node's hub, a router) busy for a while. A station serves one
//   access after the other, first come first served. The accesses of an attempt join the queue when the
//   attempt begins, but one needs the result of another: each waits as long as the queue was then. If a
//   station is requested beyond its capacity, its queue grows until the workers that wait in it request no
//   more than the capacity. Where accesses that find a station busy try again, like requests that a directory
//   rejects, they occupy the station the longer, the more of them wait (`retries`).
//
// Each worker waits for the accesses of one attempt at a time, which bounds the queues. Counted accesses
// times a fraction are not integers: they stand for the mean.
#pragma once

#include <deque>
#include <vector>

#include "runtime/access_tally.h"
#include "runtime/machine_model.h"
#include "runtime/worker_id.h"

namespace podm {

class RemoteMemory {
 public:
  /// Worker i is on node nodes[i].
  RemoteMemory(const MachineModel& machine, std::vector<NodeIndex> nodes);

  struct Delay {
    double latency_s = 0, network_s = 0;
  };
  /// Returns the delay of the accesses that the worker has made since its last call; they start at `now_s`.
  /// Calls must come in the order of time.
  Delay delay(WorkerId worker, const AccessTally& accesses, double now_s);

 private:
  // The accesses that wait at a station or are served there.
  struct Queue {
    struct Batch {
      double served_at_s;
      double num_accesses;
    };
    std::deque<Batch> batches;  // in order of service
    double num_accesses = 0;    // in all batches

    void drop_served(double now_s);
  };

  double accesses_to(WorkerId worker, NodeIndex node, const AccessTally& accesses);
  double waits_at(std::size_t station, double num_accesses, double now_s);

  const MachineModel& machine_;
  std::vector<NodeIndex> nodes_;
  std::vector<double> charged_;  // per worker and node: accesses that went there, in all calls until now
  std::vector<double> asked_;    // per station: accesses that an attempt requests
  std::vector<Queue> queues_;    // per station
};

}  // namespace podm
