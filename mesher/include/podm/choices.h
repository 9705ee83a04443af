// The choices of a run. Each choice has one table of names, which parses options, prints help and writes
// records.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "podm/errors.h"

namespace podm {

/// Is specialised for each choice. kAll is an array of pairs of a value and its name, in the order of the
/// help.
template <class Choice>
struct Names;

template <class Choice>
concept Named = requires {
  Names<Choice>::kAll;
};

/// Throws InternalError for a value that has no name.
template <Named Choice>
std::string to_string(Choice choice) {
  for (const auto& [value, name] : Names<Choice>::kAll)
    if (value == choice) return name;
  throw InternalError("a choice without a name");
}

/// The division of work among threads. kPodm: all threads work anywhere, with locks. kPdrPodm: PODM makes an
/// initial mesh; computing nodes of several threads then refine it leaf by leaf of an octree. kPdr: one
/// thread per leaf, without locks. kPodmHome: with locks, each computing node in its own block of space.
/// kAuto: kPodm, or kPodmHome where threads are pinned to several NUMA nodes.
enum class Algorithm { kAuto, kPodm, kPdr, kPdrPodm, kPodmHome };
template <>
struct Names<Algorithm> {
  static constexpr std::array kAll{std::pair{Algorithm::kAuto, "auto"}, std::pair{Algorithm::kPodm, "podm"},
                                   std::pair{Algorithm::kPdr, "pdr"},
                                   std::pair{Algorithm::kPdrPodm, "pdr-podm"},
                                   std::pair{Algorithm::kPodmHome, "podm-home"}};
};

/// The reaction of a worker to a vertex that another worker has locked; see workers/contention_manager.h.
enum class Contention { kAggressive, kRandom, kGlobal, kLocal };
template <>
struct Names<Contention> {
  static constexpr std::array kAll{
      std::pair{Contention::kAggressive, "aggressive"}, std::pair{Contention::kRandom, "random"},
      std::pair{Contention::kGlobal, "global"}, std::pair{Contention::kLocal, "local"}};
};

/// The begging worker that a worker with spare cells serves first: the one that has begged longest, or the
/// nearest in the machine; see workers/begging_list.h.
enum class Begging { kRandom, kHierarchical };
template <>
struct Names<Begging> {
  static constexpr std::array kAll{std::pair{Begging::kRandom, "random"},
                                   std::pair{Begging::kHierarchical, "hierarchical"}};
};

/// The executor of the workers: threads, or one core that runs them in virtual time (workers/virtual_time.h).
enum class Executor { kThreads, kVirtual };
template <>
struct Names<Executor> {
  static constexpr std::array kAll{std::pair{Executor::kThreads, "threads"},
                                   std::pair{Executor::kVirtual, "virtual"}};
};

/// The duration of an attempt in virtual time: 1 us, or a duration that depends on its work, in the
/// proportions of a measured run. Both vary at random by half.
enum class VirtualCost { kUnit, kMeasured };
template <>
struct Names<VirtualCost> {
  static constexpr std::array kAll{std::pair{VirtualCost::kUnit, "unit"},
                                   std::pair{VirtualCost::kMeasured, "measured"}};
};

/// The frame of vertex coordinates. All frames are in mm except `voxel` (continuous voxel indices).
enum class Space { kRas, kLps, kVoxel };
template <>
struct Names<Space> {
  static constexpr std::array kAll{std::pair{Space::kRas, "RAS"}, std::pair{Space::kLps, "LPS"},
                                   std::pair{Space::kVoxel, "voxel"}};
};

/// The version of Gmsh's format: binary 4.1, or text 2.2, the newest version that many solvers read.
enum class GmshVersion { k4_1, k2_2 };
template <>
struct Names<GmshVersion> {
  static constexpr std::array kAll{std::pair{GmshVersion::k4_1, "4.1"}, std::pair{GmshVersion::k2_2, "2.2"}};
};

/// The fate of layers thinner than delta: kept, by smaller deltas there, or lost.
enum class Thin { kKeep, kLose };
template <>
struct Names<Thin> {
  static constexpr std::array kAll{std::pair{Thin::kKeep, "keep"}, std::pair{Thin::kLose, "lose"}};
};

/// The surface of objects that touch the image's border: rounded there, or the flat sides of the image's box.
enum class BoxFaces { kOpen, kFlat };
template <>
struct Names<BoxFaces> {
  static constexpr std::array kAll{std::pair{BoxFaces::kOpen, "open"}, std::pair{BoxFaces::kFlat, "flat"}};
};

/// The field of an image of values: a voxel has one value, or values are trilinear between voxel centers and,
/// along each axis, constant from the border voxels on.
enum class ValuesOf { kConstant, kTrilinear };
template <>
struct Names<ValuesOf> {
  static constexpr std::array kAll{std::pair{ValuesOf::kConstant, "voxels"},
                                   std::pair{ValuesOf::kTrilinear, "trilinear"}};
};

/// The operations of optimisation: replace the cells around an edge or on both sides of facets, move a
/// vertex, fill a cavity with any cells, fill a cavity with any cells and a new vertex, and give a flat cell
/// on an interface to another label.
enum class OptimizationMeans { kFlips, kMoves, kSearches, kAddedVertices, kPeels };
template <>
struct Names<OptimizationMeans> {
  static constexpr std::array kAll{std::pair{OptimizationMeans::kFlips, "flips"},
                                   std::pair{OptimizationMeans::kMoves, "moves"},
                                   std::pair{OptimizationMeans::kSearches, "searches"},
                                   std::pair{OptimizationMeans::kAddedVertices, "added_vertices"},
                                   std::pair{OptimizationMeans::kPeels, "peels"}};
};

/// The reason why a cell stays beyond the bounds: two facets of one interface make the angle; facets of two
/// interfaces make the angle where three labels meet; all vertices are on the isosurface; or none of these.
enum class OptimizationObstacle { kFrozenFacets, kJunction, kFrozenVertices, kOther };
template <>
struct Names<OptimizationObstacle> {
  static constexpr std::array kAll{std::pair{OptimizationObstacle::kFrozenFacets, "frozen_facets"},
                                   std::pair{OptimizationObstacle::kJunction, "junction"},
                                   std::pair{OptimizationObstacle::kFrozenVertices, "frozen_vertices"},
                                   std::pair{OptimizationObstacle::kOther, "other"}};
};

/// kNumberLimit: the run used all cell numbers, although memory was left.
enum class StopReason { kComplete, kCancelled, kElementLimit, kTimeLimit, kMemoryLimit, kNumberLimit };
template <>
struct Names<StopReason> {
  static constexpr std::array kAll{std::pair{StopReason::kComplete, "complete"},
                                   std::pair{StopReason::kCancelled, "cancelled"},
                                   std::pair{StopReason::kElementLimit, "element limit"},
                                   std::pair{StopReason::kTimeLimit, "time limit"},
                                   std::pair{StopReason::kMemoryLimit, "memory limit"},
                                   std::pair{StopReason::kNumberLimit, "limit of 2^30 cells in the store"}};
};

}  // namespace podm
