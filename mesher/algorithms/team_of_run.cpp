#include "algorithms/team_of_run.h"

#include "algorithms/image_owners.h"
#include "image/image_by_bricks.h"

namespace podm {

namespace {

std::map<std::string, double> constants_of(const MachineModel& machine) {
  std::map<std::string, double> constants{
      {"core_speed", machine.core_speed}, {"miss_share", machine.miss_share}, {"retries", machine.retries}};
  const auto first_router = static_cast<std::size_t>(machine.num_nodes());
  if (machine.stations.size() > first_router && machine.stations[first_router].service_s > 0)
    constants["router_accesses_per_s"] = 1 / machine.stations[first_router].service_s;
  return constants;
}

}  // namespace

TeamOfRun::TeamOfRun(const MeshingOptions& options)
    : options_(options), placement_(place_team(options.team)), size_(team_size(options, placement_.places)) {}

void TeamOfRun::locate_memory(const LabelImage& image, const FeatureTransform& transform) {
  if (placement_.machine.num_nodes() == 1 || by_bricks(image) != nullptr) return;
  owners_ = owners_of_image(image, transform, placement_, options_.team.seed, nodes_of_pages);
  if (placement_.is_real) pages_.emplace(placement_.machine, *owners_, nodes_of_pages);
}

void TeamOfRun::forget_reads() {
  if (owners_ && options_.team.executor == Executor::kVirtual)
    owners_->watch_first_reads(placement_.machine.num_nodes());
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
          .model = placement_.model ? &*placement_.model : nullptr,
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
  if (placement_.model && options_.team.executor == Executor::kVirtual)
    report.simulated_machine = {.name = placement_.model->name, .constants = constants_of(*placement_.model)};
  report.pages = pages_ ? std::move(pages) : PageSamples{.phases = {}, .unavailable = why_no_pages()};
  if (owners_) report.image_reads_unavailable = owners_->unavailable();
}

std::string TeamOfRun::why_no_pages() const {
  if (placement_.machine.num_nodes() == 1) return "the machine has one NUMA node";
  if (placement_.machine.is_this_machine()) return "workers in virtual time are on no node";
  return "the machine is described by a file";
}

}  // namespace podm
