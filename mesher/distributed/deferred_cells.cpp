#include "distributed/deferred_cells.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "distributed/messages.h"
#include "geometry/circumsphere.h"
#include "runtime/parallel_collect.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

// A deferred cell also requests vertices within this many of its circumradii. A larger factor costs more than
// it saves.
constexpr double kKnownOverRadius = 1;

}  // namespace

CellName name_of(const Mesh& mesh, CellId c) {
  CellName name;
  for (std::size_t i = 0; i < 4; ++i) name.vertices[i] = mesh.point(mesh.cell(c).vertices[i]);
  std::sort(name.vertices.begin(), name.vertices.end(), lexicographically_less);
  return name;
}

Ball circumscribed_ball(const CellName& name, double extent) {
  const auto& v = name.vertices;
  const Point center = circumsphere(v[0], v[1], v[2], v[3], extent).center;
  return {center, distance(center, v[0])};
}

std::vector<std::size_t> along_curve(const std::vector<CellName>& names, const CubeGrid& grid,
                                     std::size_t threads) {
  std::vector<std::pair<MortonCode, std::size_t>> places(names.size());
  parallel_for_each(names.size(), threads, [&](std::size_t i) {
    places[i] = {grid.place_on_curve(names[i].vertices[0]), i};
  });
  parallel_sort(places.begin(), places.end(), threads);
  std::vector<std::size_t> order;
  for (const auto& place : places) order.push_back(place.second);
  return order;
}

// The deferred cells with their centers in one cube.
struct ZonesInRounds::Waiting {
  CubeId cube;
  std::uint32_t cells;
  Ball largest;
};

ZonesInRounds::ZonesInRounds(const CubeGrid& grid, const Blocks& blocks, double extent, std::size_t threads,
                             Communication& ranks)
    : grid_(grid),
      blocks_(blocks),
      extent_(extent),
      threads_(threads),
      ranks_(ranks),
      zones_(grid, blocks),
      load_(static_cast<std::size_t>(ranks.size())) {}

std::vector<CellName> ZonesInRounds::plan_next(int round, const std::vector<CellName>& deferred,
                                               const Writers& writers) {
  std::vector<CubeCount> num_waiting;
  const CubeSet waiting = share_waiting(deferred, round < kShiftedRounds ? nullptr : &num_waiting);
  zones_ = zones_of_round(round + 1, blocks_, waiting.grown(1), num_waiting, writers, load_);
  if (zones_.are_connected()) reach_over_radius_ *= 2;
  std::vector<std::vector<CellName>> names = by_rank(deferred);
  if (round < kShiftedRounds) add_load(names);
  std::vector<CellName> here = std::exchange(names[static_cast<std::size_t>(ranks_.rank())], {});
  const std::vector<CellName> more = exchanged(names, ranks_);
  here.insert(here.end(), more.begin(), more.end());
  return here;
}

CubeSet ZonesInRounds::wanted(CubeSet around_zone, const std::vector<CellName>& names) const {
  CubeSet wanted = std::move(around_zone);
  for (const Waiting& here : by_cube(names))
    wanted.insert(here.largest.center, kKnownOverRadius * here.largest.radius);
  return wanted;
}

// Groups cells by the cube of their center. The largest ball of a cube stands for all, because the other
// balls hardly reach other places.
std::vector<ZonesInRounds::Waiting> ZonesInRounds::by_cube(const std::vector<CellName>& names) const {
  std::vector<Waiting> each(names.size());
  parallel_for_each(names.size(), threads_, [&](std::size_t i) {
    const Ball ball = ball_of(names[i]);
    each[i] = {grid_.cube_at(ball.center), 1, ball};
  });
  parallel_sort(each.begin(), each.end(), threads_, [](const Waiting& a, const Waiting& b) {
    return a.cube != b.cube ? a.cube < b.cube : a.largest.radius > b.largest.radius;
  });
  std::vector<Waiting> by_cube;
  for (const Waiting& one : each) {
    if (by_cube.empty() || by_cube.back().cube != one.cube) {
      by_cube.push_back(one);
    } else {
      ++by_cube.back().cells;
    }
  }
  return by_cube;
}

// Returns the cubes that the deferred cells of all ranks request. Adds the numbers of cells with their
// centers in each cube to `num_waiting`, if it is given.
CubeSet ZonesInRounds::share_waiting(const std::vector<CellName>& deferred,
                                     std::vector<CubeCount>* num_waiting) {
  CubeSet around(grid_), waiting(grid_);
  Bytes message;
  std::vector<CubeCount> counts;
  for (const Waiting& here : by_cube(deferred)) {
    around.insert(here.largest.center, reach_over_radius_ * here.largest.radius);
    if (num_waiting != nullptr) counts.push_back({here.cube, here.cells});
  }
  append(message, around.runs());
  append(message, counts);
  for (const Bytes& received : ranks_.all_gather(std::move(message))) {
    MessageReader reader(received);
    for (const auto& run : reader.read<CubeRun>()) waiting.insert(run);
    for (const CubeCount& more : reader.read<CubeCount>()) num_waiting->push_back(more);
  }
  return waiting;
}

// A cell belongs to the zone with its center.
std::vector<std::vector<CellName>> ZonesInRounds::by_rank(const std::vector<CellName>& deferred) const {
  std::vector<int> rank_of(deferred.size());
  parallel_for_each(deferred.size(), threads_, [&](std::size_t i) {
    rank_of[i] = zones_.rank_of(grid_.place_of(ball_of(deferred[i]).center));
  });
  std::vector<std::vector<CellName>> names(static_cast<std::size_t>(ranks_.size()));
  for (std::size_t i = 0; i < deferred.size(); ++i)
    names.at(static_cast<std::size_t>(rank_of[i])).push_back(deferred[i]);
  return names;
}

void ZonesInRounds::add_load(const std::vector<std::vector<CellName>>& by_rank) {
  std::vector<std::uint64_t> more;
  for (const std::vector<CellName>& of_rank : by_rank) more.push_back(of_rank.size());
  ranks_.sum(more);
  std::transform(more.begin(), more.end(), load_.begin(), load_.begin(), std::plus<>());
}

}  // namespace podm
