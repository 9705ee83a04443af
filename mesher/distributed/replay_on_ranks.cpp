#include "distributed/replay_on_ranks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "distributed/collective_errors.h"
#include "distributed/completion.h"
#include "distributed/messages.h"
#include "distributed/vertex_histories.h"
#include "podm/mesh_io.h"
#include "replay/replay.h"
#include "run/extract_mesh.h"
#include "runtime/parallel_for.h"
#include "smoothing/smooth_interfaces.h"

namespace podm {

namespace {

CubeSet set_of(const CubeGrid& grid, const std::vector<CubesOfRank::Run>& runs) {
  CubeSet cubes(grid);
  for (const auto& [first, last] : runs) {
    if (last >= grid.num_cubes()) throw InputError(fmt::format("the grid has no cube {}", last));
    for (CubeId cube = first; cube <= last; ++cube) cubes.insert(cube);
  }
  return cubes;
}

CubeGrid grid_of(const OperationLogHead& head) {
  if (!head.cubes) throw InputError("the log does not say which part of space its rank had");
  const auto& [x, y, z, far_x, far_y, far_z] = head.cubes->grid;
  return CubeGrid({{x, y, z}, {far_x, far_y, far_z}}, head.cubes->side_mm);
}

class Replay {
 public:
  Replay(const LabelImage& image, const OperationLog& own, Space space, int threads, Communication& ranks,
         SharedValue<Isosurface>& isosurface)
      : image_(image),
        own_(own),
        space_(space),
        threads_(num_threads(threads)),
        ranks_(ranks),
        isosurface_(isosurface) {}

  ReplayOnRanks operator()() {
    expect_one_run();
    std::optional<CubeGrid> grid;
    do_collectively([&] { grid.emplace(grid_of(own_.head)); }, ranks_);
    const std::vector<std::vector<CubesOfRank::Run>> blocks = of_all_ranks(own_.head.cubes->block);
    std::vector<int> rank_of_cube;
    ReplayOnRanks sums;
    // Ranks of one process take turns up to here, so that there is one triangulation at a time.
    do_collectively(
        [&] {
          rank_of_cube = ranks_of_cubes(blocks, *grid);
          add_own(*grid, sums);
        },
        ranks_);
    check_histories(*grid, rank_of_cube);
    std::array<std::uint64_t, 4> values{sums.operations, sums.seeds, sums.cells, sums.mesh_hash};
    ranks_.sum(values);
    return {values[0], values[1], values[2], values[3]};
  }

 private:
  void expect_one_run() {
    const OperationLogHead& head = own_.head;
    do_collectively(
        [&] {
          if (head.num_ranks != ranks_.size() || head.rank != ranks_.rank())
            throw InputError(fmt::format("the log is that of rank {} of {}", head.rank, head.num_ranks));
        },
        ranks_);
    expect_agreement({{"image of the log", head.image_sha256},
                      {"space of the log", head.space},
                      {"hash of the mesh in the log", head.mesh_hash},
                      {"smoothing in the log", fmt::format("{} mm", head.smoothing_mm)},
                      {"virtual box in the log", fmt::format("{}", fmt::join(head.box, " "))}},
                     ranks_);
    const CubesOfRank cubes = head.cubes.value_or(CubesOfRank());
    expect_agreement({{"grid of the log", fmt::format("{} {}", fmt::join(cubes.grid, " "), cubes.side_mm)}},
                     ranks_);
  }

  std::vector<std::vector<CubesOfRank::Run>> of_all_ranks(const std::vector<CubesOfRank::Run>& runs) {
    Bytes message;
    append(message, runs);
    std::vector<std::vector<CubesOfRank::Run>> all;
    for (const Bytes& received : ranks_.all_gather(std::move(message)))
      all.push_back(values_of<CubesOfRank::Run>(received));
    return all;
  }

  static std::vector<int> ranks_of_cubes(const std::vector<std::vector<CubesOfRank::Run>>& blocks,
                                         const CubeGrid& grid) {
    constexpr int kNobody = -1;
    std::vector<int> rank_of_cube(grid.num_cubes(), kNobody);
    for (std::size_t rank = 0; rank < blocks.size(); ++rank)
      for (const CubeId cube : set_of(grid, blocks[rank]).cubes()) {
        if (rank_of_cube[cube] != kNobody)
          throw InputError(
              fmt::format("cube {} is in the blocks of ranks {} and {}", cube, rank_of_cube[cube], rank));
        rank_of_cube[cube] = static_cast<int>(rank);
      }
    const auto missing = std::find(rank_of_cube.begin(), rank_of_cube.end(), kNobody);
    if (missing != rank_of_cube.end())
      throw InputError(fmt::format("cube {} is in no rank's block", missing - rank_of_cube.begin()));
    return rank_of_cube;
  }

  // Replays this rank's log, and adds its part of the mesh.
  void add_own(const CubeGrid& grid, ReplayOnRanks& sums) {
    const std::unique_ptr<Mesh> mesh = replay(own_);
    const CubeSet block = set_of(grid, own_.head.cubes->block);
    if (const auto unknown = unknown_cells(*mesh, block, set_of(grid, own_.head.cubes->known), threads_);
        !unknown.empty())
      throw InputError(
          fmt::format("{} cells of its part may not be cells of the whole mesh", unknown.size()));
    const TetMesh part = part_in(block, *mesh);
    sums.mesh_hash = mesh_hash(part, static_cast<int>(threads_));
    sums.cells = part.cells.size();
    for (const LoggedOperation& logged : own_.all.operations) {
      sums.operations += logged.kind > kMovedVertex && logged.kind < kReceivedInsertion;
      sums.seeds += logged.kind >= kSeed;
    }
  }

  // Returns the cells whose least vertices are in the block, and their facets.
  TetMesh part_in(const CubeSet& block, Mesh& mesh) {
    const int threads = static_cast<int>(threads_);
    const auto make = [&] {
      return std::make_shared<const Isosurface>(image_, threads,
                                                weights_of(image_, own_.head.smoothing_mm, threads));
    };
    const std::shared_ptr<const Isosurface> isosurface = isosurface_.get(make, ranks_);
    label_cells(mesh, *isosurface, threads);
    const auto is_own = [&](CellId c) {
      const auto& vertices = mesh.cell(c).vertices;
      return block.has(mesh.point(*std::min_element(vertices.begin(), vertices.end(), [&](auto a, auto b) {
        return lexicographically_less(mesh.point(a), mesh.point(b));
      })));
    };
    std::vector<std::uint8_t> is_wanted(mesh.cell_bound());  // extraction consumes the cells
    for (CellId c = 0; c < mesh.cell_bound(); ++c)
      is_wanted[c] = mesh.cell(c).is_alive() && mesh.label(c) != kBackground && is_own(c);
    std::uint64_t facets_off_isosurface = 0;
    const bool is_voxel = space_ == Space::kVoxel;
    TetMesh part = extract_mesh(mesh, *isosurface, is_voxel ? Space::kRas : space_, threads,
                                facets_off_isosurface, [&](CellId c) { return is_wanted[c] != 0; });
    if (is_voxel) convert_to_voxel_space(part, image_, threads);
    return part;
  }

  void check_histories(const CubeGrid& grid, const std::vector<int>& rank_of_cube) {
    std::vector<std::vector<VertexEvent>> events(static_cast<std::size_t>(ranks_.size()));
    for (const VertexEvent& event : events_of(own_))
      events[static_cast<std::size_t>(rank_of_cube[grid.cube_at(event.point)])].push_back(event);
    std::vector<Bytes> messages = messages_of(events);
    events = {};
    messages = ranks_.all_to_all(std::move(messages));
    const std::vector<std::vector<CubesOfRank::Run>> known = of_all_ranks(own_.head.cubes->known);
    const auto check = [&] {
      VertexHistories histories(set_of(grid, own_.head.cubes->block));
      for (std::size_t rank = 0; rank < messages.size(); ++rank)
        histories.add(static_cast<int>(rank), values_of<VertexEvent>(std::exchange(messages[rank], {})),
                      known[rank]);
      histories.check();
    };
    do_collectively(check, ranks_);
  }

  const LabelImage& image_;
  const OperationLog& own_;
  const Space space_;
  const std::size_t threads_;
  Communication& ranks_;
  SharedValue<Isosurface>& isosurface_;
};

}  // namespace

ReplayOnRanks replay_on_ranks(const LabelImage& image, const OperationLog& own, Space space, int threads,
                              Communication& ranks, SharedValue<Isosurface>& isosurface) {
  return Replay(image, own, space, threads, ranks, isosurface)();
}

}  // namespace podm
