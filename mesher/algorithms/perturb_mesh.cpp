#include "algorithms/perturb_mesh.h"

#include <new>
#include <numeric>

#include "algorithms/perturb_loop.h"
#include "algorithms/sample_lines.h"

namespace podm {

namespace {

template <class Locks, class Time>
class Phase {
 public:
  Phase(Construction& construction, const Parameters& parameters, Time& time)
      : construction_(construction),
        mesh_(construction.mesh()),
        time_(time),
        workers_(construction.make_workers<Locks>(parameters, construction.num_workers(), kPerturb)) {
    begin_perturbation(construction, workers_);
  }
  ~Phase() {
    construction_.stop().observe_by([](std::uint64_t) {});  // the workers that it reads are destroyed
  }

  PerturbationReport operator()() {
    const DihedralBounds& bounds = *construction_.problem().dihedral_bounds;
    PerturbationReport report;
    report.min_dihedral_deg = bounds.least_deg();
    report.max_dihedral_deg = bounds.largest_deg();
    report.before = list_poor(true);
    observe(report.before.number());
    perturb_listed(construction_, workers_, time_);
    count_unmoved(report);
    if (time_.is_over()) {  // the cells in `unmoved` have been tried
      report.after = list_poor(false);
      report.not_reached =
          report.after.number() - std::accumulate(report.unmoved.begin(), report.unmoved.end(), 0ull);
    }
    construction_.account(workers_, time_);
    return report;
  }

 private:
  static constexpr CellId kLookahead = 8;

  // Counts the poor cells, and lists them if `gives`. Each worker has a part of the store, which does not
  // change meanwhile.
  PerturbationReport::Cells list_poor(bool gives) {
    std::vector<PerturbationReport::Cells> found(workers_.size());
    const auto list = [&](WorkerId self) {
      Worker<Locks>& worker = *workers_[self];
      const std::size_t bound = mesh_.cell_bound();
      const auto begin = static_cast<CellId>(bound * self / workers_.size()),
                 end = static_cast<CellId>(bound * (self + 1) / workers_.size());
      for (CellId c = begin; c < end; ++c) {
        if (c + kLookahead < end) mesh_.prefetch_vertices(c + kLookahead);
        if (!mesh_.cell(c).is_alive() || !worker.perturbation().is_poor(c)) continue;
        PerturbationReport::Cells& cells = found[self];
        ++(has_free_vertex(mesh_, c) ? cells.with_free_vertex : cells.without);
        if (gives) worker.give(c);
      }
      return end - begin;
    };
    if (gives) {
      time_.run([&](WorkerId self) { judge_cells(self, list, time_); });
    } else {
      for (WorkerId self = 0; self < workers_.size(); ++self) list(self);
    }
    PerturbationReport::Cells sum;
    for (const PerturbationReport::Cells& cells : found) {
      sum.with_free_vertex += cells.with_free_vertex;
      sum.without += cells.without;
    }
    return sum;
  }

  // Reports the cells that the last round kept. A cell that became poor was listed, and one that was tried
  // without success was kept.
  void count_unmoved(PerturbationReport& report) {
    for (const auto& worker : workers_) {
      for (const auto& [entry, why] : worker->take_kept()) {
        if (mesh_.stamp(entry.cell) != entry.stamp) continue;
        ++report.unmoved[static_cast<std::size_t>(why)];
        ++(has_free_vertex(mesh_, entry.cell) ? report.after.with_free_vertex : report.after.without);
      }
    }
  }

  // Estimates the progress from the first worker's part.
  void observe(std::uint64_t num_poor) {
    if (!construction_.problem().observe_perturbation) return;
    construction_.stop().observe_by([this, num_poor](std::uint64_t cells) {
      const double left = static_cast<double>(workers_[0]->num_listed() * workers_.size());
      construction_.problem().observe_perturbation(1 - left / static_cast<double>(num_poor + 1), cells);
    });
  }

  Construction& construction_;
  const Mesh& mesh_;
  Time& time_;
  const Construction::Workers<Locks> workers_;
};

}  // namespace

void perturb_mesh(Construction& construction, const Parameters& parameters) {
  if (!construction.problem().dihedral_bounds || construction.stop().is_over()) return;
  construction.timed(kPerturb, [&] {
    // Memory may run out for the lists between rounds, too, not only for workers.
    const auto run = [&](auto& time) {
      using Time = std::remove_reference_t<decltype(time)>;
      if (construction.num_workers() > 1 || construction.team().executor == Executor::kVirtual) {
        construction.report(Phase<VertexLocks, Time>(construction, parameters, time)());
      } else {
        construction.report(Phase<NoLocks, Time>(construction, parameters, time)());
      }
    };
    try {
      construction.in_time(kPerturb, construction.num_workers(), run, kPerturb);
    } catch (const std::bad_alloc&) {
      construction.stop().end(StopReason::kMemoryLimit);
    }
  });
  construction.sample_pages(kPerturb);
  mend_lines(construction, parameters);  // a move may take an edge at the floor out of the mesh
}

}  // namespace podm
