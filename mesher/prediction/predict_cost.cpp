#include "prediction/predict_cost.h"

#include <algorithm>
#include <ctime>
#include <numeric>

#include "algorithms/check_options.h"
#include "algorithms/memory_model.h"
#include "algorithms/team_size.h"
#include "podm/image_io.h"
#include "prediction/cost_model.h"
#include "prediction/radius_search.h"
#include "sizing/default_sizes.h"
#include "sizing/make_size_grid.h"

namespace podm {

namespace {

// The phantom has many interfaces, as segmentations have.
constexpr const char* kPhantom = "abdomen";
constexpr int kPhantomSize = 64, kTrials = 2;
constexpr std::uint64_t kTrialCellsPerThread = 60'000;
constexpr int kMostThreadsOfTrial = 16;  // up to this number the trial's mesh grows with the threads
// Fixed time of any run, fitted to processor seconds: creates files, starts hashes, returns memory.
constexpr double kSecondsOfAnyRun = 0.02;
// The trial's mesh is small enough for the caches. Other runs need this factor more time for their work, as
// measured in 32 runs.
constexpr double kRunOverTrialTime = 1.25;

// The cost of a background cell, and of a square of an interface with side delta, relative to that of a cell
// of the mesh. The factors were fitted to processor seconds of 28 runs.
double work_of(double cells, double stored_cells, double squares) {
  constexpr double kBackgroundOverMesh = 0.93, kSquareOverMesh = 0.98;
  return cells + kBackgroundOverMesh * (stored_cells - cells) + kSquareOverMesh * squares;
}

SizeOptions resolved(const LabelImage& image, const SizeOptions& asked, const CostModel& model, int threads) {
  if (asked.target_elements > 0) return RadiusSearch(image, asked, threads).sizes();
  SizeOptions sizes = asked;
  sizes.delta_mm = delta_mm_for(image, asked, model.census());
  return sizes;
}

// The seconds that this machine presently takes for the work of one cell of the phantom: the best of several
// trials.
double trial_seconds_of_work(const MeshingOptions& options) {
  const int threads = num_workers(options.team);
  const LabelImage phantom = make_phantom(kPhantom, kPhantomSize, loop_threads(options.team));
  MeshingOptions trial = options;
  trial.log = nullptr;
  trial.smoothing_mm = 0;  // the length is for the other image
  trial.limits = {};
  const auto cells =
      kTrialCellsPerThread * static_cast<std::uint64_t>(std::min(threads, kMostThreadsOfTrial));
  trial.sizes = RadiusSearch(phantom, {.target_elements = cells}, threads).sizes();
  trial.sizes.target_elements = 0;
  const double squares = CostModel(phantom, threads).squares(trial.sizes);
  double best_s = 0;
  for (int n = 0; n < kTrials; ++n) {
    const WorkTimer timer(threads);
    const MeshingResult made = mesh_image(phantom, trial);
    const double seconds = timer.seconds() / work_of(static_cast<double>(made.mesh.cells.size()),
                                                     static_cast<double>(made.report.store_cells), squares);
    best_s = n == 0 ? seconds : std::min(best_s, seconds);
  }
  return best_s;
}

}  // namespace

double WorkTimer::now_s() const {
  std::timespec time{};
  clock_gettime(threads_ == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Cost predict_cost(const LabelImage& image, const MeshingOptions& options) {
  check_options(image, options);
  const int threads = loop_threads(options.team);
  const auto grid = make_size_grid(image, options.sizes, threads);
  const CostModel model(image, threads, census_of(image, options.sizes, grid.get()));
  Cost cost;
  cost.sizes = resolved(image, options.sizes, model, threads);
  cost.cells_of_label = model.cells_by_label(cost.sizes);
  cost.layers = kept_layers(image, cost.sizes, threads);
  if (cost.layers) cost.growth_at_layers = model.growth_with(*cost.layers, cost.sizes);
  for (double& cells : cost.cells_of_label) cells *= cost.growth_at_layers;
  cost.cells = std::accumulate(cost.cells_of_label.begin(), cost.cells_of_label.end(), 0.0);
  cost.stored_cells = cost.cells + cost.growth_at_layers * model.background_cells(cost.sizes);
  cost.mesh_bytes =
      kPeakBytesPerStoredCell * cost.stored_cells + static_cast<double>(kBytesOfOutput) +
      static_cast<double>(bytes_of_threads(static_cast<std::uint64_t>(num_workers(options.team))));
  cost.mesh_s = kSecondsOfAnyRun +
                kRunOverTrialTime * trial_seconds_of_work(options) *
                    work_of(cost.cells, cost.stored_cells, cost.growth_at_layers * model.squares(cost.sizes));
  return cost;
}

}  // namespace podm
