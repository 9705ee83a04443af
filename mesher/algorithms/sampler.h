// Inserts samples while no other worker runs: of lines, and of a flat box.
#pragma once

#include "algorithms/construction.h"
#include "workers/accounting.h"

namespace podm {

/// The only worker. It finds cells by walks from the last one.
class Sampler {
 public:
  Sampler(const Sampler&) = delete;

 protected:
  /// Keeps references. The phase is charged with the time that the worker takes to be made.
  Sampler(Construction& construction, const Parameters& parameters, const char* phase)
      : stop_(construction.stop()),
        mesh_(construction.mesh()),
        workers_(construction.make_workers<NoLocks>(parameters, 1, phase)),
        worker_(*workers_.front()) {}
  ~Sampler() { worker_.flush_log(); }

  /// One look at the limits takes much less time than an insertion or the cells around a vertex.
  bool is_over() {
    meter_.report(worker_, stop_);
    stop_.check_limits();
    return stop_.is_over();
  }

  StopControl& stop_;
  Mesh& mesh_;

 private:
  CellMeter meter_;
  const Construction::Workers<NoLocks> workers_;

 protected:
  Worker<NoLocks>& worker_;
  CellId last_ = 0;
};

}  // namespace podm
