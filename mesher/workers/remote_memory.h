// What the memory of other nodes costs the workers of a described machine: the way there and back, and the
// waiting where the network is busy.
//
//   A counted access to another node's cell or vertex goes there with the machine's `miss_share`; the rest
//   are answered by caches. It then takes longer than one at home by the latency of the links between.
//   Of image and transform, which nobody writes, each line goes over the network once to each node, whose
//   caches keep it.
//   On its way an access keeps each station (a node's hub, a router) busy for a while. Stations serve one
//   access after the other, the first to come first. Those of an attempt come to the queue at its beginning,
//   but one needs what the other brings: each waits as long as the queue was then. When a station is asked
//   for more than it can do, its queue grows until the workers, who wait in it, ask for no more than that.
//   Where accesses that find a station busy come again, as requests do that a directory turns away, they take
//   it longer the more of them wait (`retries`).
//
// Each worker waits for the accesses of one attempt at a time, which bounds the queues. Counted accesses
// times a share are no whole numbers: they stand for their mean.
#pragma once

#include <deque>
#include <vector>

#include "runtime/access_tally.h"
#include "runtime/machine_model.h"
#include "runtime/worker_id.h"

namespace podm {

class RemoteMemory {
 public:
  /// Worker i stands on node nodes[i].
  RemoteMemory(const MachineModel& machine, std::vector<NodeIndex> nodes);

  struct Delay {
    double latency_s = 0, network_s = 0;
  };
  /// Of the worker's accesses since it was asked for the last time, which set out at `now_s`. Calls come in
  /// the order of time.
  Delay delay(WorkerId worker, const AccessTally& accesses, double now_s);

 private:
  // Who waits at a station, or is served there.
  struct Queue {
    struct Batch {
      double served_at_s;
      double num_accesses;
    };
    std::deque<Batch> batches;  // in their order
    double num_accesses = 0;    // of all of them

    void drop_served(double now_s);
  };

  double accesses_to(WorkerId worker, NodeIndex node, const AccessTally& accesses);
  double waits_at(std::size_t station, double num_accesses, double now_s);

  const MachineModel& machine_;
  std::vector<NodeIndex> nodes_;
  std::vector<double> charged_;  // by worker and node: accesses that went there, in all calls until now
  std::vector<double> asked_;    // by station: what an attempt asks of it
  std::vector<Queue> queues_;    // by station
};

}  // namespace podm
