#include "distributed/mesh_image_on_ranks.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <numeric>
#include <string_view>

#include "algorithms/check_options.h"
#include "algorithms/memory_model.h"
#include "distributed/collective_errors.h"
#include "distributed/image_digest.h"
#include "distributed/memory_of_ranks.h"
#include "distributed/pieces.h"
#include "distributed/rank_failure.h"
#include "distributed/report_of_ranks.h"
#include "image/image_by_bricks.h"
#include "io/sha256.h"
#include "podm/mesh_io.h"
#include "run/calibrate.h"
#include "run/extract_mesh.h"
#include "run/measure_quality.h"
#include "run/phases_of_run.h"
#include "runtime/system_memory.h"
#include "runtime/virtual_threads.h"

namespace podm {

namespace {

constexpr double kBytesPerGib = 1 << 30;

void refuse(bool is_asked, const std::string& what) {
  if (is_asked) throw InputError(what + " is not available on ranks");
}

// True if the option of this name has its default value.
template <class Value>
bool is_default(std::string_view name, const Value& value) {
  bool is_equal = true;
  for_each_option(MeshingOptions(), [&]<class Other>(const Declaration& of, const Other& other) {
    if constexpr (std::same_as<Value, Other>)
      if (of.name == name) is_equal = value == other;
  });
  return is_equal;
}

}  // namespace

void check_options_on_ranks(const MeshingOptions& options) {
  refuse(options.algorithm == Algorithm::kPodmHome, "algorithm " + to_string(options.algorithm));
  if (options.team.executor == Executor::kVirtual && VirtualThreads::current() == nullptr)
    throw InputError("virtual time needs ranks that are threads of one process (--in-process)");
  refuse(options.leaves.with_schedule, "a schedule of leaves");
  for_each_option(options, [](const Declaration& of, const auto& value) {
    refuse(of.not_on_ranks && !is_default(of.name, value), spelled(of));
  });
}

namespace {

std::string hash_of(const SizeImage* image) {
  if (image == nullptr) return "none";
  Sha256 hash;
  hash.update(std::span<const int>(image->size));
  hash.update(std::span<const double>(image->voxel_to_ras));
  hash.update(std::span<const float>(image->radius_mm));
  return "SHA-256 " + hash.hexadecimal();
}

std::string hash_of(const LabelImage& image, int threads) {
  Sha256 hash;
  hash.update(std::span<const int>(image.size));
  hash.update(std::span<const double>(image.spacing));
  hash.update(std::span<const double>(image.voxel_to_ras));
  hash.update(std::span<const char>(digest_of(image, threads)));
  for (const Label& label : image.labels) {
    hash.update(std::span<const std::uint32_t>(&label.value, 1));
    hash.update(std::span<const char>(label.name));
  }
  return hash.hexadecimal();
}

// Returns the facts that determine the mesh; they must be the same on all ranks.
std::vector<Fact> facts_of(const LabelImage& image, const MeshingOptions& options) {
  const SizeOptions& sizes = options.sizes;
  std::string radii;
  for (const auto& [value, radius_mm] : sizes.radius_of_mm) radii += fmt::format("{}={} ", value, radius_mm);
  std::string near;
  for (const InterfaceSize& of : sizes.near)
    near += fmt::format("{},{}={}:{} ", fmt::join(of.labels[0], "+"), fmt::join(of.labels[1], "+"),
                        of.radius_mm, of.width_mm);
  return {{"radius", fmt::format("{} mm", sizes.radius_mm)},
          {"radii of labels", radii},
          {"delta", fmt::format("{} mm", sizes.delta_mm)},
          {"target number of elements", fmt::format("{} within {} %, {} meshes", sizes.target_elements,
                                                    sizes.target_tolerance_percent, sizes.target_meshes)},
          {"size image", hash_of(sizes.image.get())},
          {"sizes near interfaces", near},
          {"growth of sizes", fmt::format("{}", sizes.grade)},
          {"smoothing", fmt::format("{} mm", options.smoothing_mm)},
          {"least dihedral angle", fmt::format("{} degrees", options.min_dihedral_deg)},
          {"space", to_string(options.space)},
          {"algorithm", to_string(options.algorithm)},
          {"leaf size", fmt::format("{} mm", options.leaves.size_mm)},
          {"initial ratio", fmt::format("{}", options.leaves.initial_ratio)},
          {"seed", fmt::format("{}", options.cut_seed)},
          {"limit of elements", fmt::format("{}", options.limits.max_elements)},
          {"limit of seconds", fmt::format("{}", options.limits.max_seconds)},
          {"image", "SHA-256 " + hash_of(image, loop_threads(options.team))}};
}

// Returns the facts that a run shares with the checkpoint that it resumes. Limits and the cuts between blocks
// may differ.
std::vector<Fact> facts_of_checkpoints(const LabelImage& image, const MeshingOptions& options) {
  std::vector<Fact> facts = facts_of(image, options);
  std::erase_if(facts,
                [](const Fact& fact) { return fact.first == "seed" || fact.first.starts_with("limit of "); });
  facts.insert(facts.begin(), {"program version", PODM_VERSION});
  return facts;
}

void check_checkpoints(const CheckpointOptions& checkpoints, const MeshingOptions& options, int num_ranks) {
  if (checkpoints.folder.empty()) return;
  refuse(options.sizes.target_elements > 0, "a checkpoint of a run with a target number of elements");
  if (num_ranks == 1 && !checkpoints.is_resumed)
    throw InputError(
        "checkpoints are written between rounds, and one rank has a single round: use more ranks");
}

MeshingOptions with_algorithm(MeshingOptions options) {
  if (options.algorithm == Algorithm::kAuto) options.algorithm = Algorithm::kPodm;
  return options;
}

// One rank's part of a run.
class RunOnRank {
 public:
  RunOnRank(const LabelImage& image, const MeshingOptions& options, Communication& ranks,
            const ProgressCallback& progress, EndOnAllRanks& end, SharedInProcess* shared)
      : image_(image),
        options_(with_algorithm(options)),
        ranks_(ranks),
        shared_(ranks.size() > 1 ? shared : nullptr),
        end_(end),
        progress_([&end, progress](const Progress& now) {
          end.hear();
          if (progress) progress(now);
        }),
        phases_(image, options_, progress_, end_.token(), 1.0 / ranks.size(),
                [&ranks] { return ranks.seconds(); }) {}

  /// Collective. To be called before the run.
  void open(const CheckpointOptions& options) {
    if (!options.folder.empty())
      checkpoints_.emplace(options, facts_of_checkpoints(image_, options_), ranks_);
  }

  MeshingOnRanks operator()() {
    MeshingOnRanks result;
    MeshingReport own;
    phases_.transform(own, [&](auto weights) { return isosurface(std::move(weights)); });
    spending_.end("transform");
    try {
      make_piece(own, result.piece);
    } catch (const std::bad_alloc&) {
      refined_.reset();
      throw lack_of_memory();
    }
    result.mesh_hash = hash_of_whole(result.piece.mesh);
    result.cubes = std::move(refined_->cubes);
    if (checkpoints_ && checkpoints_->is_resumed())
      result.resumed = ResumedFrom{checkpoints_->resumed()->rounds, checkpoints_->resumed()->pieces.size()};
    spending_.end("measure");
    PartOfRank part{.cells = result.piece.mesh.cells.size(),
                    .boundary_facets = result.piece.mesh.facets.size(),
                    .store_cells = own.store_cells,
                    .phases_s = own.phases_s,
                    .spent = spending_.by_phase(),
                    .rounds = refined_->rounds,
                    .perturbing_rounds = refined_->perturbing_rounds,
                    .seeds = refined_->seeds,
                    .last_update = refined_->last_update,
                    .image_bytes_read = phases_.isosurface().transform().bytes_read()};
    std::tie(result.report, result.parts) = report_of_ranks(std::move(own), std::move(part), ranks_);
    phases_.promise_dihedral_bounds(result.piece.mesh, result.report);
    if (result.report.stop_reason == StopReason::kMemoryLimit) warn_of_memory(result.report);
    result.report.guarantees.missing_labels =
        missing_labels(image_, result.report.cells_of_label, phases_.loop_threads());
    return result;
  }

 private:
  void make_piece(MeshingReport& own, MeshPiece& made) {
    refine(own);
    phases_.report_refinement(refined_->refinement, own);
    phases_.extract([&](Space space) { made = piece(space, own.guarantees.facet_vertices); }, own);
    spending_.end("extract");
    phases_.finish(made.mesh, own);
  }

  std::uint64_t bytes_for_part() const {
    return std::min(memory_of_run(options_.limits), address_space_bytes());
  }

  // If the prediction is that these ranks would do, it is wrong by an unknown factor. Twice as many have
  // parts of half the size.
  std::uint64_t num_ranks_that_would_do(std::uint64_t bytes) const {
    const auto num_ranks = static_cast<std::uint64_t>(ranks_.size());
    const std::uint64_t predicted = num_ranks_for(phases_.expected_cells(), static_cast<double>(bytes));
    return predicted > num_ranks ? predicted : 2 * num_ranks;
  }

  // More ranks in this process would share the same memory.
  std::string memory_that_would_do(std::uint64_t num_ranks, std::uint64_t bytes) const {
    if (shared_ == nullptr) return fmt::format("{} or more ranks of this memory would do", num_ranks);
    return fmt::format("{:.3g} GiB for the stores of all ranks would do",
                       static_cast<double>(num_ranks * bytes) / kBytesPerGib);
  }

  OutOfMemory lack_of_memory() const {
    const std::uint64_t bytes = bytes_for_part(), num_ranks = num_ranks_that_would_do(bytes);
    const double gib = static_cast<double>(bytes) / kBytesPerGib,
                 more = static_cast<double>(num_ranks) / ranks_.size();
    return OutOfMemory(fmt::format(
        "out of memory: its part of the mesh, about {:.2g} cells, needs about {:.3g} GiB and has "
        "{:.3g}; {}",
        phases_.expected_cells() / ranks_.size(), gib * more, gib, memory_that_would_do(num_ranks, bytes)));
  }

  void warn_of_memory(MeshingReport& report) {
    const std::uint64_t bytes = bytes_for_part();
    std::array<std::uint64_t, 1> num_ranks{num_ranks_that_would_do(bytes)};
    ranks_.maximum(num_ranks);
    report.warnings.push_back("memory ended the run; " + memory_that_would_do(num_ranks[0], bytes));
  }

  std::shared_ptr<const Isosurface> isosurface(std::shared_ptr<const VoxelWeights> weights) {
    const auto make = [&] {
      return std::make_shared<const Isosurface>(image_, phases_.loop_threads(), std::move(weights));
    };
    return shared_ != nullptr ? shared_->isosurface.get(make, ranks_) : make();
  }

  // Collective in its first call, so that no rank takes cells before all have added theirs.
  Problem with_shared_cells(Problem problem) {
    if (shared_ == nullptr) return problem;
    if (!has_added_cells_) {
      shared_->cells.add(problem.cell_capacity);
      has_added_cells_ = true;
      ranks_.barrier();
    }
    problem.cell_capacity = std::min(kMostShares * problem.cell_capacity, problem.most_numbered_cells);
    problem.shared_cells = &shared_->cells;
    return problem;
  }

  void refine(MeshingReport& own) {
    SizeOptions sizes = options_.sizes;
    if (sizes.target_elements > 0) return refine_to_target(own);
    sizes.delta_mm = phases_.delta_mm();
    refine_with(sizes, own);
  }

  void refine_to_target(MeshingReport& own) {
    const auto begin = [&] {
      std::optional<RadiusSearch> search;
      do_collectively([&] { search.emplace(image_, options_.sizes, phases_.loop_threads()); }, ranks_);
      return *search;
    };
    const auto make = [&](const SizeOptions& sizes) {
      expect_agreement(
          {{"radius for the target number of elements", fmt::format("{:a} mm", sizes.radius_mm)}}, ranks_);
      if (refined_) spending_.reassign(refined_->spent, "calibrate");
      refined_.reset();  // frees the memory of the mesh before
      refine_with(sizes, own);
      return reason_on_any_rank();
    };
    const auto count = [&] { return num_cells(); };
    podm::refine_to_target(options_.sizes, {begin, make, count, [&] { return ranks_.seconds(); }}, own);
  }

  StopReason reason_on_any_rank() const {
    std::array<std::uint64_t, 1> reason{static_cast<std::uint64_t>(refined_->refinement.stop_reason)};
    ranks_.maximum(reason);
    return static_cast<StopReason>(reason[0]);
  }

  std::uint64_t num_cells() {
    if (ranks_.size() > 1)
      return count_cells(*refined_, phases_.isosurface(), phases_.loop_threads(), ranks_);
    return label_cells(*refined_->refinement.mesh, phases_.isosurface(), phases_.loop_threads());
  }

  void refine_with(const SizeOptions& sizes, MeshingReport& own) {
    phases_.refine(sizes, [&](const Problem& problem, const Team& team, StopControl& stop) {
      spending_.end(options_.sizes.target_elements > 0 ? "calibrate" : "transform");
      if (ranks_.size() == 1 && !checkpoints_) return refine_alone(problem, team, stop);
      const Problem own_problem = with_shared_cells(problem);
      const double start_s = ranks_.seconds();
      refined_.emplace(podm_distributed(own_problem, team,
                                        {.initial_ratio = options_.leaves.initial_ratio,
                                         .cut_seed = options_.cut_seed,
                                         .algorithm = options_.algorithm,
                                         .leaf_size_mm = options_.leaves.size_mm,
                                         .checkpoints = checkpoints_ ? &*checkpoints_ : nullptr,
                                         .end = &end_},
                                        ranks_, stop));
      double known_s = 0;
      for (const auto& [phase, seconds] : refined_->refinement.phases_s) known_s += seconds;
      own.phases_s["exchange"] = std::max(0.0, ranks_.seconds() - start_s - known_s);
    });
    spending_.end(refined_->spent);
  }

  std::uint64_t hash_of_whole(const TetMesh& own) const {
    std::array<std::uint64_t, 1> hash{mesh_hash(own, phases_.loop_threads())};
    ranks_.sum(hash);
    return hash[0];
  }

  void refine_alone(const Problem& problem, const Team& team, StopControl& stop) {
    const Vector extent = problem.object.high - problem.object.low;
    const CubeGrid grid(problem.object, std::max({extent.x, extent.y, extent.z}));
    Spending spending(ranks_);
    refined_.emplace(DistributedRefinement{
        .refinement = refine_by(options_.algorithm, problem, team, options_.leaves, stop),
        .grid = grid,
        .blocks = Blocks(grid, 1, 1),
        .rounds = {},
        .perturbing_rounds = {},
        .seeds = 0,
        .last_update = {}});
    spending.end("refine");
    refined_->spent = spending.by_phase();
  }

  MeshPiece piece(Space space, std::uint64_t& facets_off_isosurface) {
    MeshPiece piece;
    if (ranks_.size() > 1) {
      piece = extract_piece(*refined_, phases_.isosurface(), space, phases_.loop_threads(), ranks_,
                            facets_off_isosurface);
    } else {
      piece.mesh = extract_mesh(*refined_->refinement.mesh, phases_.isosurface(), space,
                                phases_.loop_threads(), facets_off_isosurface);
      piece.vertex_ids.resize(piece.mesh.vertices.size());
      std::iota(piece.vertex_ids.begin(), piece.vertex_ids.end(), std::uint64_t{0});
      piece.owns_vertex.assign(piece.vertex_ids.size(), 1);
      piece.total_vertices = piece.vertex_ids.size();
      piece.total_cells = piece.mesh.cells.size();
      piece.total_facets = piece.mesh.facets.size();
    }
    refined_->refinement.mesh.reset();
    return piece;
  }

  const LabelImage& image_;
  const MeshingOptions options_;
  Communication& ranks_;
  SharedInProcess* const shared_;  // null: this rank shares nothing
  EndOnAllRanks& end_;
  const ProgressCallback progress_;
  PhasesOfRun phases_;
  Spending spending_{ranks_};
  bool has_added_cells_ = false;
  std::optional<Checkpoints> checkpoints_;
  std::optional<DistributedRefinement> refined_;
};

}  // namespace

MeshingOnRanks mesh_image_on_ranks(const LabelImage& image, const MeshingOptions& options,
                                   Communication& ranks, const ProgressCallback& progress,
                                   std::stop_token stop, SharedInProcess* shared,
                                   const CheckpointOptions& checkpoints) {
  EndOnAllRanks end(ranks, std::move(stop));
  std::optional<RunOnRank> run;
  do_collectively(
      [&] {
        by_bricks(image) != nullptr ? check_options_but_voxels(image, options)
                                    : check_options(image, options);
        check_options_on_ranks(options);
        check_checkpoints(checkpoints, options, ranks.size());
        run.emplace(image, options, ranks, progress, end, shared);
      },
      ranks);
  if (ranks.size() > 1) expect_agreement(facts_of(image, options), ranks);
  run->open(checkpoints);
  return (*run)();
}

}  // namespace podm
