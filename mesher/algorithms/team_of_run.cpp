#include "algorithms/team_of_run.h"

#include "algorithms/image_owners.h"

namespace podm {

TeamOfRun::TeamOfRun(const MeshingOptions& options)
    : options_(options), placement_(place_team(options.team)), size_(team_size(options, placement_.places)) {}

void TeamOfRun::locate_memory(const LabelImage& image, const FeatureTransform& transform) {
  if (placement_.machine.num_nodes() == 1) return;
  owners_ = owners_of_image(image, transform, placement_, options_.team.seed, nodes_of_pages);
  if (placement_.is_real) pages_.emplace(placement_.machine, *owners_, nodes_of_pages);
}

Team TeamOfRun::team() const {
  return {.executor = options_.team.executor,
          .coordination = {.num_workers = size_.num_workers,
                           .contention = options_.team.contention,
                           .groups = placement_.groups,
                           .seed = options_.team.seed},
          .num_nodes = size_.num_nodes,
          .initial_workers = size_.initial_workers,
          .cost = options_.team.virtual_cost,
          .log = options_.log,
          .machine = &placement_.machine,
          .places = placement_.places,
          .owners = owners_ ? &*owners_ : nullptr,
          .pages = pages_ ? &*pages_ : nullptr};
}

void TeamOfRun::report_to(MeshingReport& report, PageSamples pages) const {
  report.algorithm = size_.algorithm;
  report.computing_nodes = size_.num_nodes;
  report.num_nodes = placement_.machine.num_nodes();
  report.pages = pages_ ? std::move(pages) : PageSamples{.phases = {}, .unavailable = why_no_pages()};
  if (owners_) report.image_reads_unavailable = owners_->unavailable();
}

std::string TeamOfRun::why_no_pages() const {
  if (placement_.machine.num_nodes() == 1) return "the machine has one NUMA node";
  if (placement_.machine.is_this_machine()) return "workers of virtual time are on no node";
  return "the machine is a described one";
}

}  // namespace podm
