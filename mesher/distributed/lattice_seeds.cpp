#include "distributed/lattice_seeds.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/mix.h"
#include "runtime/parallel_collect.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

// The side of the largest leaf over the bound on the circumradius. Balls have up to 0.56 of a side. A side of
// 2 radii makes 1.5 to 3 % more cells than a mesh without seeds has, 3 radii 0.02 %.
constexpr double kSizeOverRadius = 3;
constexpr double kJitter = 0.01;  // of the least side
// The largest side of a sparse leaf over its distance. Smaller ones cost more seeds than they save.
constexpr double kSparseSideOverDistance = 4;
constexpr unsigned kMostDepth = 20;

// The generator SplitMix64, for numbers from -1 to 1.
double next_in_unit_range(std::uint64_t& state) {
  return static_cast<double>(mix(state += 0x9e3779b97f4a7c15u) >> 11) * 0x1p-52 - 1;
}

double gap(double low, double high, double other_low, double other_high) {
  return std::max({0.0, other_low - high, low - other_high});
}

}  // namespace

// The root's side is a power of two times the least side of leaves, which are therefore as large as allowed
// where the bound is least.
LatticeSeeds::LatticeSeeds(const Problem& problem, const Box& box, std::size_t threads, double coarser)
    : problem_(problem),
      box_(box),
      threads_(threads),
      radii_(radii_of(problem)),
      side_over_radius_(coarser * kSizeOverRadius) {
  const double least_side_mm = side_over_radius_ * radii_.least;
  const Vector extent = box.high - box.low;
  root_side_mm_ = least_side_mm;
  while (root_side_mm_ < std::max({extent.x, extent.y, extent.z})) root_side_mm_ *= 2;
  const double half = root_side_mm_ / 2;
  root_low_ = box.low + 0.5 * extent - Vector{half, half, half};
  jitter_mm_ = kJitter * least_side_mm;
}

Box LatticeSeeds::box_of(const Node& node) const {
  const double unit_mm = root_side_mm_ / (1u << kMostDepth), side = side_mm(node);
  const Point low = root_low_ + unit_mm * Vector{1.0 * node.low[0], 1.0 * node.low[1], 1.0 * node.low[2]};
  return {low, low + Vector{side, side, side}};
}

// Where the isosurface may pass, the least bound at the corners and at the center counts, or the largest of
// the object if none of these points is inside.
bool LatticeSeeds::is_leaf(const Node& node) const {
  constexpr double kHalfDiagonal = 0.8660254037844387;
  if (node.depth + 1 == kMostDepth) return true;
  const double side = side_mm(node);
  const auto& [low, high] = box_of(node);
  const Point center = low + 0.5 * (high - low);
  const LabelIndex label = problem_.isosurface.label_at(center);
  const double reach = kHalfDiagonal * side;
  if (problem_.isosurface.distance_lower_bound(center, reach) > reach)
    return label == kBackground ||
           side <= side_over_radius_ * std::sqrt(problem_.sizes.squared_radius(label, center));
  double radius = label == kBackground ? radii_.most : radius_at(problem_, label, center);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Point p{corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z};
    const LabelIndex there = problem_.isosurface.label_at(p);
    if (there != kBackground) radius = std::min(radius, radius_at(problem_, there, p));
  }
  return side <= side_over_radius_ * radius;
}

Point LatticeSeeds::point_of(MortonCode code) const {
  const double unit_mm = root_side_mm_ / (1u << kMostDepth);
  const GridPoint at = morton_point(code);
  std::uint64_t state = code;
  const double x = next_in_unit_range(state), y = next_in_unit_range(state), z = next_in_unit_range(state);
  return root_low_ + unit_mm * Vector{1.0 * at[0], 1.0 * at[1], 1.0 * at[2]} + jitter_mm_ * Vector{x, y, z};
}

// Descends level by level. Returns the corners and centers of the taken nodes that are within the box and
// wanted, each once.
template <class FateOf, class IsWanted>
std::vector<Point> LatticeSeeds::collect(const FateOf& fate_of, const IsWanted& is_wanted) const {
  constexpr std::size_t kLength = 64;
  const auto half_side = [](const Node& node) { return 1u << (kMostDepth - node.depth - 1); };
  const auto corner_of = [](const Node& node, unsigned corner, std::uint32_t step) {
    return GridPoint{node.low[0] + (corner & 1) * step, node.low[1] + (corner >> 1 & 1) * step,
                     node.low[2] + (corner >> 2) * step};
  };
  std::vector<Node> level{{{0, 0, 0}, 0}};
  std::vector<MortonCode> codes;
  std::vector<Fate> fates;
  while (!level.empty()) {
    fates.assign(level.size(), Fate::kSkipped);
    parallel_for_ranges(level.size(), kLength, threads_,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t i = begin; i < end; ++i) fates[i] = fate_of(level[i]);
                        });
    const auto taken = parallel_collect<MortonCode>(
        level.size(), threads_, [&](std::size_t begin, std::size_t end, std::vector<MortonCode>& found) {
          for (std::size_t i = begin; i < end; ++i) {
            if (fates[i] != Fate::kTaken) continue;
            const std::uint32_t half = half_side(level[i]);
            for (unsigned corner = 0; corner < 8; ++corner)
              found.push_back(morton_code(corner_of(level[i], corner, 2 * half)));
            found.push_back(morton_code(corner_of(level[i], 7, half)));
          }
        });
    codes.insert(codes.end(), taken.begin(), taken.end());
    level = parallel_collect<Node>(
        level.size(), threads_, [&](std::size_t begin, std::size_t end, std::vector<Node>& children) {
          for (std::size_t i = begin; i < end; ++i)
            for (unsigned corner = 0; corner < 8 && fates[i] == Fate::kDivided; ++corner)
              children.push_back({corner_of(level[i], corner, half_side(level[i])), level[i].depth + 1});
        });
  }
  parallel_sort(codes.begin(), codes.end(), threads_);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return parallel_collect<Point>(codes.size(), threads_,
                                 [&](std::size_t begin, std::size_t end, std::vector<Point>& points) {
                                   for (std::size_t i = begin; i < end; ++i)
                                     if (const Point p = point_of(codes[i]); is_in(box_, p) && is_wanted(p))
                                       points.push_back(p);
                                 });
}

std::vector<Point> LatticeSeeds::in(const CubeSet& cubes) const {
  const double margin = 2 * jitter_mm_;
  const auto fate_of = [&](const Node& node) {
    const Box box = grown(box_of(node), margin);
    const CubePlace low = cubes.grid().place_of(box.low), last = cubes.grid().place_of(box.high);
    if (!cubes.meets({low, {last[0] + 1, last[1] + 1, last[2] + 1}})) return Fate::kSkipped;
    return is_leaf(node) ? Fate::kTaken : Fate::kDivided;
  };
  return collect(fate_of, [&](const Point& p) { return cubes.has(p); });
}

std::vector<Point> LatticeSeeds::sparse_around(const Box& box) const {
  const auto fate_of = [&](const Node& node) {
    const Box its = box_of(node);
    const double distance_mm = std::max({gap(its.low.x, its.high.x, box.low.x, box.high.x),
                                         gap(its.low.y, its.high.y, box.low.y, box.high.y),
                                         gap(its.low.z, its.high.z, box.low.z, box.high.z)});
    if (is_in(box, its.low) && is_in(box, its.high)) return Fate::kSkipped;
    const bool is_far = side_mm(node) <= kSparseSideOverDistance * distance_mm;
    return is_far || is_leaf(node) ? Fate::kTaken : Fate::kDivided;
  };
  return collect(fate_of, [](const Point&) { return true; });
}

}  // namespace podm
